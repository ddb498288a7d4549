"""Loads of a die: strain range of a cycle, life of its cells, force to eject.

Public: `strain_cycle.StrainCycle`, `die_surfaces.DieSurfaces`,
`ejection_force.EjectionForces`.
"""
