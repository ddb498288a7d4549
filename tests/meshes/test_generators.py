"""The generators by the names that case files call them by."""

import inspect

import pytest

from castx.meshes.blocks import slab, stacked_blocks, two_slabs
from castx.meshes.box import box_in_mould
from castx.meshes.cylinder import cylinder_in_mould
from castx.meshes.generators import GENERATORS
from castx.meshes.ring import core_in_ring

pytestmark = pytest.mark.serial


def test_all_generators_are_known_by_their_names():
    assert GENERATORS == {
        "slab": slab,
        "two_slabs": two_slabs,
        "cylinder_in_mould": cylinder_in_mould,
        "stacked_blocks": stacked_blocks,
        "box_in_mould": box_in_mould,
        "core_in_ring": core_in_ring,
    }


@pytest.mark.parametrize("name", GENERATORS)
def test_all_generators_take_the_sizes_and_kinds_of_cells_by_name(name):
    parameters = inspect.signature(GENERATORS[name]).parameters
    assert {"model", "size", "interface_size", "order_of_growth", "cells"} <= set(parameters)
    assert {p.kind for p in parameters.values()} == {inspect.Parameter.KEYWORD_ONLY}
