"""Foundry quantities of a solidification: pure functions of arrays, without mesh or run.

`mush_column`, `moving_front`, `skeleton` and `melt_levels` are flow of melt through the mush on one
line. `identification` fits interface data to samples; `front`, `pools`, `stress` and `followed`
follow foundry quantities in a run, from step to step.

Public: `mush.FreezingPath`, `porosity.niyama`, `porosity.dimensionless_niyama`,
`porosity.pore_fraction`, `arm_spacing.ArmSpacing`, `arm_spacing.yield_strength`,
`modulus.thermal_modulus`, `hot_tearing.clyne_davies`, `hot_tearing.kou`, `suction.MushSuction`,
`cracking.cold_crack_index`, `distortion.best_fit`, `roundness.flatness`, `roundness.roundness`,
`die_life.Fatigue`, `mush_column.MushResistance`, `mush_column.column_suction`,
`moving_front.PoresBehindFront`, `skeleton.consolidation`, `skeleton.undrained`,
`melt_levels.communicating`, `bending.ThinWalls`.
"""
