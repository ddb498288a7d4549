"""Geometries meshed with gmsh: those of `generators` with arguments, those of `cad` from files.

Public: `linear_mesh.LinearMesh`, `model.fill_model`, `model.plane`, `structured.grid`,
`structured.swept`, `grading.Sizing`, `grading.graded`, `grading.uniform`.
"""
