"""Results handed over to other programs: stresses, thermal histories, distorted surfaces.

Public: `export.exported`, `export.Request`, `body_state.BodyState`, `calculix.write_calculix`,
`tables.write_nodes`, `tables.write_exaca`, `surfaces.write_surface`, `surfaces.write_mould_mesh`.
"""
