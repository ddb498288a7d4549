"""Surfaces that a machine clamps: where it presses, its force and the stiffness behind it.

Public: `direction.press_direction`, `clamp.SurfaceClamp`, `clamp.Clamp`.
"""
