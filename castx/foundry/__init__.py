"""Foundry quantities of a solidification: pure functions of arrays, without mesh or run.

Public: `mush.FreezingPath`, `porosity.niyama`, `porosity.dimensionless_niyama`,
`porosity.pore_fraction`, `arm_spacing.ArmSpacing`, `arm_spacing.yield_strength`,
`modulus.thermal_modulus`, `hot_tearing.clyne_davies`, `hot_tearing.kou`, `suction.MushSuction`,
`cracking.cold_crack_index`, `distortion.best_fit`, `roundness.flatness`, `roundness.roundness`,
`die_life.Fatigue`.
"""
