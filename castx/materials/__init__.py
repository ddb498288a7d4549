"""Materials: properties from the case and the database, enthalpy, thermal strain and flow.

`rules` is what flow and hardening rules declare; `flow_rules` and `hardening` have one file for
each. `scheil` asks thermodynamic databases, with the packages of the extra `calphad`.

Public: `material.Material`, `description.MaterialDescription`, `lookup.find_material`,
`database.database_entry`, `database.database_names`, `enthalpy.EnthalpyCurve`,
`conduction_potential.ConductionPotential`, `thermal_strain.volumetric_thermal_strain`,
`flow.FlowProperties`, `inelastic.FLOW_RULES`, `inelastic.HARDENING_RULES`,
`inelastic.flow_rules`, `inelastic.rule_table`, `foundry_data.ArmSpacingData`,
`foundry_data.StrengthData`, `foundry_data.FatigueData`, `scheil.Composition`,
`scheil.scheil_table`, `scheil.case_text`.
"""
