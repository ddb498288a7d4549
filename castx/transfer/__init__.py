"""Heat through interfaces and surfaces: coefficients of node pairs, and conditions of surfaces.

`laws` has one file for each law h(gap, pressure, temperature, time), `conditions` one for each
heat condition of a surface; `database` is interfaces of metal and mould with sources and ranges,
and `naming` how a case names one.

Public: `conductance.Conductance`, `conductance.ConductionLaw`, `conductance.Faces`,
`declaration.GapHeatLaw`, `declaration.Given`, `declaration.HeatKey`,
`coefficients.closed_coefficient`, `coefficients.pressure_term`, `coefficients.under_pressure`,
`duals.Dual`, `pair_state.PairState`, `registry.gap_heat_laws`, `registry.law_table`,
`user_law.UserLaw`, `database.interface_names`, `database.interface_entry`,
`database.InterfaceEntry`, `database.SourcedNumber`, `naming.with_entry`, `naming.changed`.
"""
