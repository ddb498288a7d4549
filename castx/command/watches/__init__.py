"""Warnings of a run: values outside their range, deformations, forces.

Public: `range_watch.RangeWatch`, `deformation_watch.DeformationWatch`, `force_watch.ForceWatch`.
"""
