"""Strain of the mush, cold cracks, residual stress, distortion, and what dies bear.

The loads come through the surfaces of bodies: `heat_flux`, and `first_opening` of their gaps.

Public: `strains.BodyStrains`, `cold_cracks.BodyColdCracks`, `cracks.Cracks`,
`strain_cycle.StrainCycle`, `die_surfaces.DieSurfaces`, `ejection_force.EjectionForces`,
`stresses.StressExtremes`, `shape.Shape`, `stage_ends.StageEnds`, `surface_forms.SurfaceForms`,
`heat_flux.HeatFluxes`, `first_opening.FirstOpenings`.
"""
