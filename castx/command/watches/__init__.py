"""What a run warns of as it goes on: ranges left, missing forces, absurd displacements.

Public: `ranges.RangeWatch`, `deformations.DeformationWatch`, `forces.ForceWatch`.
"""
