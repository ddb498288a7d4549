"""Forms of the page: the keys of a case as fields, by the schema of the case.

Public: `actions.shown_forms`, `actions.with_field`, `actions.with_added`, `keys.keys_of`.
"""
