"""Histories of a run beside thermal history and pools, behind one face.

Public: `histories.Histories`, `histories.histories_of`.
"""
