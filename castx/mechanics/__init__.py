"""Quasi-static balance of momentum of one body: formulations, loads and prescribed directions.

Public: `body.BodyMechanics`, `description.MechanicalBody`, `description.SurfaceLoad`,
`formulation.Formulation`, `mixed.MixedFormulation`, `q1p0.Q1P0Formulation`,
`displacement.DisplacementFormulation`, `osgs.OrthogonalProjection`, `trapped_liquid.Pockets`,
`fixed_directions.SurfaceDisplacement`, `fixed_directions.fixed_directions`,
`assembly.BodyAssembly`, `rigid_modes.rigid_modes`, `rigid_modes.near_null_modes`.
"""
