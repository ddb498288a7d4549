"""Parametrised geometries, meshed with gmsh.

A generator fills the current gmsh model with linear cells, simplices or quadrilaterals and
hexahedra, whose physical volumes are the bodies and whose physical surfaces are the named faces. It
raises ValueError for arguments that make no geometry.
"""

from collections.abc import Callable

from castx.meshes.blocks import slab, stacked_blocks, two_slabs
from castx.meshes.box import box_in_mould
from castx.meshes.cylinder import cylinder_in_mould
from castx.meshes.ring import core_in_ring

__all__ = [
    "GENERATORS",
    "box_in_mould",
    "core_in_ring",
    "cylinder_in_mould",
    "slab",
    "stacked_blocks",
    "two_slabs",
]

GENERATORS: dict[str, Callable[..., None]] = {
    generator.__name__: generator
    for generator in (
        slab,
        two_slabs,
        cylinder_in_mould,
        stacked_blocks,
        box_in_mould,
        core_in_ring,
    )
}
