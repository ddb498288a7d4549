"""Quasi-static balance of momentum of one body: formulations, loads and prescribed directions.

`constitutive` is the stress at a point; `liquid` is where liquid is cut off, and its pressure;
`mush` is melt that flows through a mush; `midsides` makes displacements quadratic.
`clamp` holds surfaces that a machine clamps: direction, force, stiffness.

Public: `body.BodyMechanics`, `description.MechanicalBody`, `description.SurfaceLoad`,
`formulation.Formulation`, `mixed.MixedFormulation`, `q1p0.Q1P0Formulation`,
`taylor_hood.TaylorHoodFormulation`, `fixed_midsides.midside_directions`,
`darcy.DarcyFormulation`, `displacement.DisplacementFormulation`, `osgs.OrthogonalProjection`,
`trapped_liquid.Pockets`, `fixed_directions.SurfaceDisplacement`,
`fixed_directions.fixed_directions`, `assembly.BodyAssembly`, `rigid_modes.rigid_modes`,
`rigid_modes.near_null_modes`,
`press_direction.press_direction`, `clamp.SurfaceClamp`, `clamp.Clamp`.
"""
