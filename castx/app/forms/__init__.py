"""Forms of the page: the keys of a case by its schema, the size of its part, the mesh it makes."""
