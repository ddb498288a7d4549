"""All generators by name."""

from collections.abc import Callable

from castx.meshes.blocks import slab, stacked_blocks, two_slabs
from castx.meshes.box import box_in_mould
from castx.meshes.cylinder import cylinder_in_mould
from castx.meshes.ring import core_in_ring

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
