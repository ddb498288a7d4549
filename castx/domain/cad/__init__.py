"""Meshes of CAD files, made in a process of their own: CAD kernels crash and write to the terminal.

Public: `guarded.meshed_apart`, `description.part_of`, `child.main`,
`new_case.write_new_case`.
"""
