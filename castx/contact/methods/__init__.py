"""Contact methods, one file each: name and keys in a case, formula, source and pair law.

Public: `registry.METHODS`, `registry.names`, `registry.method_table`, `description.ContactMethod`,
`description.Key`, `description.PairLaw`
"""
