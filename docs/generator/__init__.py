"""What turns the code, the registries and the notebooks into pages of the documentation."""
