"""What a run watches as it goes on: ranges left, missing forces, absurd values, signals.

Public: `ranges.RangeWatch`, `deformations.DeformationWatch`, `forces.ForceWatch`,
`temperatures.TemperatureWatch`, `interruption.Interruption`.
"""
