"""All foundry quantities that a run follows: its fields, and the histories behind one face.

Public: `foundry_fields.FoundryFields`, `histories.Histories`, `histories.histories_of`.
"""
