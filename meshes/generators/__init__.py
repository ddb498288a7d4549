"""Geometries with arguments, one in each file: what a case may say of it, and how it is meshed.

Public: `declaration.Generator`, `declaration.Argument`, `declaration.COMMON_ARGUMENTS`,
`slab.slab`, `slab.GENERATOR`, and in each other file the function of its name and its declaration.

A generator fills the current gmsh model with linear cells, simplices or quadrilaterals and
hexahedra, whose physical volumes are the bodies and whose physical surfaces are the named faces. It
raises ValueError for arguments that make no geometry. No file here needs gmsh to be imported: a
case is checked without it.
"""
