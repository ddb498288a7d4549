"""What freezing and cooling leave in a solid body: residual stress, and its distortion.

Public: `stresses.StressExtremes`, `shape.Shape`, `stage_ends.StageEnds`.
"""
