"""The meshed bodies: mesh, submeshes, named surfaces, measures.

Public: `mesh.build_mesh`, `mesh.CastingMesh`, `mesh.BodyMesh`, `summary.mesh_summary`,
`source.named_mesh`, `source.write_mesh`, `memory.refuse_too_large`, `measures.cell_measure`,
`measures.SurfaceMeasures`, `measures.nodal_volumes`, `measures.nodal_areas`,
`measures.nodal_area_vectors`, `surface_facets.surface_facets`, `cell_kinds.KINDS`,
`soundness.refuse_folded`, `soundness.doubts`.
"""
