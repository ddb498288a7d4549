"""What a run follows from step to step beside thermal history and pools, behind one face.

Public: `histories.Histories`, `histories.histories_of`.
"""
