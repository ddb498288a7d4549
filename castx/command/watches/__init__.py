"""What a run watches as it goes on: ranges left, missing forces, absurd displacements, signals.

Public: `ranges.RangeWatch`, `deformations.DeformationWatch`, `forces.ForceWatch`,
`interruption.Interruption`.
"""
