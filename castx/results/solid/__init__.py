"""State of a solid body after freezing and cooling: residual stress, distortion, form of surfaces.

Public: `stresses.StressExtremes`, `shape.Shape`, `stage_ends.StageEnds`,
`surface_forms.SurfaceForms`.
"""
