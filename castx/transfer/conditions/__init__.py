"""Heat conditions on the surfaces of bodies, one in each file: a flux, a temperature or nothing.

Public: `declaration.HeatConditionKind`, `declaration.FluxLaw`, `keys.AMBIENT`,
`registry.heat_conditions`.
"""
