"""From a case file to a checked case.

Public: `read.load_case`, `read.read_case`, `changes.refuse_changes`,
`changed_keys.ChangedKey`, `with_coherency.with_coherency`.
"""
