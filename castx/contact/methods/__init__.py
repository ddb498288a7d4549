"""Contact methods, one file each: what a case may ask for, keys, formula, source and pair law.

Public: `registry.METHODS`, `registry.names`, `registry.method_table`, `description.ContactMethod`,
`description.Key`, `description.PairLaw`
"""
