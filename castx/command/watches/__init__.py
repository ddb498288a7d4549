"""What a run warns of as it goes: values outside their range, deformations, forces.

Public: `range_watch.RangeWatch`, `deformation_watch.DeformationWatch`, `force_watch.ForceWatch`.
"""
