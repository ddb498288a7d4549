"""Parametrised geometries, meshed with gmsh.

Public: `generators.GENERATORS`, `blocks.slab`, `blocks.two_slabs`, `blocks.stacked_blocks`,
`box.box_in_mould`, `cylinder.cylinder_in_mould`, `ring.core_in_ring`.

A generator fills the current gmsh model with linear cells, simplices or quadrilaterals and
hexahedra, whose physical volumes are the bodies and whose physical surfaces are the named faces. It
raises ValueError for arguments that make no geometry.
"""
