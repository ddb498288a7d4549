"""Materials: properties from the case and the database, enthalpy, thermal strain and flow.

Public: `material.Material`, `description.MaterialDescription`, `lookup.find_material`,
`database.database_entry`, `database.database_names`, `enthalpy.EnthalpyCurve`,
`conduction_potential.ConductionPotential`, `thermal_strain.volumetric_thermal_strain`,
`flow.FlowProperties`, `inelastic.FLOW_RULES`, `inelastic.HARDENING_RULES`,
`inelastic.flow_rules`, `inelastic.rule_table`.
"""
