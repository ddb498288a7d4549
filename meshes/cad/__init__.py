"""CAD files, meshed with gmsh's OpenCASCADE kernel.

Public: `part.mesh_part`, `description.CadPart`, `description.CadFile`, `description.Selector`,
`report.Report`.

Solids become bodies whose touching faces are shared, so that their nodes match; free faces become
named surfaces. All numbers that come in and go out are in metres; the gmsh model itself is in
millimetres, for which OpenCASCADE's own tolerances are made. The functions raise ValueError for
files and descriptions that make no mesh.
"""
