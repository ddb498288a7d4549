"""What freezing and cooling leave in a solid body: residual stress, distortion, form of surfaces.

Public: `stresses.StressExtremes`, `shape.Shape`, `stage_ends.StageEnds`,
`surface_forms.SurfaceForms`.
"""
