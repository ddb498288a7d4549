"""Description of the geometry."""

import pytest

from castx.case.geometry import GENERATORS, Geometry, gravity_along, read_argument
from castx.errors import CaseError
from castx.input.problems import Refusal
from castx.meshes.generators.declaration import Argument, ArgumentKind

pytestmark = pytest.mark.serial

CYLINDER = {
    "generator": "cylinder_in_mould",
    "model": "axisymmetric",
    "radius": "30 mm",
    "height": "100 mm",
    "wall": 0.025,
    "size": "1.5 mm",
}
SLAB = {"generator": "slab", "model": "plane-strain", "length": 1, "width": 0.1, "size": 0.01}
BLOCKS = {
    "generator": "stacked_blocks",
    "model": "plane-strain",
    "upper": ["30 mm", "20 mm"],
    "base": [0.04, 0.03],
    "size": 0.005,
}
BOX = {
    "generator": "box_in_mould",
    "model": "plane-strain",
    "box": ["100 mm", "60 mm"],
    "wall": "20 mm",
    "size": 0.005,
}
RING = {
    "generator": "core_in_ring",
    "model": "plane-stress",
    "core_radius": 0.03,
    "outer_radius": 0.06,
    "size": 0.001,
}


def test_arguments_in_metres():
    geometry = Geometry.read({**CYLINDER, "interface_size": "0.5 mm", "order_of_growth": 2})
    assert geometry.arguments == pytest.approx(
        {
            "radius": 0.03,
            "height": 0.1,
            "wall": 0.025,
            "size": 0.0015,
            "interface_size": 0.0005,
            "order_of_growth": 2.0,
        }
    )
    assert (geometry.generator, geometry.model, geometry.gdim) == (
        "cylinder_in_mould",
        "axisymmetric",
        2,
    )


@pytest.mark.parametrize(
    "description",
    [
        SLAB,
        {**SLAB, "model": "3d", "depth": "5 cm"},
        {**SLAB, "cells": "simplices"},
        {**SLAB, "cells": "quadrilaterals"},
        {**SLAB, "model": "generalised-plane-strain"},
        {**SLAB, "generator": "two_slabs", "mould_length": 2},
        {**CYLINDER, "floor": 0},
        {**CYLINDER, "model": "3d", "sector": "quarter"},
        BLOCKS,
        {**BLOCKS, "model": "3d", "upper": [1, 1, 1], "base": [1, 1, 1], "size": 0.1},
        {**BLOCKS, "model": "axisymmetric", "symmetry": True},
        BOX,
        {**BOX, "lid": True, "model": "generalised-plane-strain"},
        {**BOX, "model": "3d", "box": [0.1, 0.06, "80 mm"]},
        RING,
        {**RING, "core_bore": 0},
        {**RING, "model": "axisymmetric", "height": 0.1},
        {"model": "3d", "file": "part.msh"},
    ],
)
def test_accepted(description):
    assert Geometry.read(description).model == description["model"]


@pytest.mark.parametrize("kind", ArgumentKind)
def test_every_kind_of_argument_is_read(kind):
    """Words of no kind are refused by a message, those of a choice unless they are among them."""
    argument = Argument(kind, choices=("half",))
    with pytest.raises(CaseError):
        read_argument(argument, {"half": 1})


def test_a_list_of_lengths():
    lengths = Argument(ArgumentKind.LENGTHS)
    assert read_argument(lengths, ["5 mm", 0.01, 0.02]) == pytest.approx((0.005, 0.01, 0.02))
    for value, text in ((0.1, "a list of 2 to 100 lengths"), ([1], "a list of 2"),
                        ([1, 0], r"\[1\]: must be positive")):  # fmt: skip
        with pytest.raises(CaseError, match=text):
            read_argument(lengths, value)


@pytest.mark.parametrize(
    "description, text",
    [
        ({**CYLINDER, "generator": "cylinder"}, 'generator: unknown.*mean "cylinder_in_mould"'),
        (
            {**CYLINDER, "generator": "plate_in_mould"},
            f"generator: not available yet; available: {', '.join(GENERATORS)}",
        ),
        ({**CYLINDER, "generator": "wheel_in_die"}, "generator: not available yet"),
        ({**CYLINDER, "generator": "engine_block_in_die"}, "generator: not available yet"),
        (
            {**CYLINDER, "model": "generalised-plane-strain"},
            "model: cylinder_in_mould is not made for this",
        ),
        ({**CYLINDER, "model": "axisymetric"}, 'model: unknown.*mean "axisymmetric"'),
        ({**CYLINDER, "model": 3}, "model: unknown; allowed: 3d, axisymmetric"),
        ({**CYLINDER, "model": "plane-strain"}, "model: cylinder_in_mould is not made for this"),
        ({"model": "axisymmetric"}, "^give either a generator or a mesh"),
        ({**CYLINDER, "file": "a.msh"}, "^give either a generator or a mesh"),
        ({"model": "3d", "file": "a.vtk"}, "file: the path of a gmsh mesh is needed"),
        (
            {"model": "3d", "file": "a.msh", "size": 1},
            "size: unknown key; known keys beside a file",
        ),
        ({"model": "3d", "parts": {"casting": "a.step"}}, "size: missing; this key is needed"),
        ({**CYLINDER, "radius": "30 s"}, "radius: 's' is not a unit of length"),
        ({**CYLINDER, "radius": 0}, r"radius: must be positive \(in m\)"),
        ({**CYLINDER, "floor": -1}, "floor: must be at least 0"),
        ({**CYLINDER, "raduis": 1}, r'raduis: unknown argument.*did you mean "radius"\?'),
        ({**CYLINDER, "arguments": {}}, "arguments: unknown argument"),
        ({k: v for k, v in CYLINDER.items() if k != "wall"}, "wall: missing; the model 'axisymm"),
        ({**CYLINDER, "sector": "half"}, "sector: has no meaning in the model 'axisymmetric'"),
        ({**CYLINDER, "model": "3d", "sector": "third"}, "sector: unknown; allowed: full, half"),
        ({**CYLINDER, "cells": "hexahedra"}, "cells: unknown; allowed: simplices, quadrilaterals"),
        ({**CYLINDER, "interface_size": "2 mm"}, "interface_size: must not exceed size, 0.0015 m"),
        ({**CYLINDER, "order_of_growth": 0}, "order_of_growth: must be positive"),
        ({**CYLINDER, "size": "1 nm"}, "size: makes about 6e.15 elements; at most 2e.08"),
        ({**SLAB, "model": "3d"}, "depth: missing; the model '3d' needs it"),
        ({**SLAB, "depth": 1}, "depth: has no meaning in the model 'plane-strain'"),
        ({**BLOCKS, "upper": [1, 1, 1]}, "upper: the model 'plane-strain' needs 2 lengths"),
        ({**BLOCKS, "upper": [1, 1]}, "upper: the base must be at least as wide"),
        ({**BLOCKS, "upper": [1]}, r"upper: two lengths \[width, height\] are needed"),
        ({**BLOCKS, "upper": [0.01, "1 K"]}, r"upper\[1\]: 'K' is not a unit of length"),
        ({**BLOCKS, "symmetry": 1}, "symmetry: true or false is needed"),
        ({**BLOCKS, "model": "axisymmetric", "symmetry": False}, "symmetry: an axisymmetric mesh"),
        ({**BOX, "model": "axisymmetric"}, "model: box_in_mould is not made for this model; its"),
        ({**BOX, "model": "3d"}, "box: the model '3d' needs 3 lengths"),
        ({**BOX, "lid": "yes"}, "lid: true or false is needed"),
        ({**BOX, "size": 1e-6}, r"size: makes about 1e.10 elements; at most 2e.08"),
        ({**RING, "outer_radius": 0.02}, "outer_radius: must be larger than core_radius"),
        ({**RING, "core_bore": 0.03}, "core_bore: must be smaller than core_radius"),
        ({**RING, "model": "3d"}, "height: missing; the model '3d' needs it"),
    ],
)
def test_refused(description, text):
    with pytest.raises(Refusal, match=text):
        Geometry.read(description)


def test_all_wrong_arguments_are_reported_together():
    with pytest.raises(Refusal) as caught:
        Geometry.read({**CYLINDER, "radius": -1, "wall": "x", "hieght": 1})
    assert {problem.path for problem in caught.value.problems} == {
        ("radius",),
        ("wall",),
        ("hieght",),
    }


@pytest.mark.parametrize(
    "model, axes, coordinates",
    [
        ("3d", ("x", "y", "z"), ("x", "y", "z", "r")),
        ("axisymmetric", ("r", "z"), ("r", "z")),
        ("generalised-plane-strain", ("x", "y"), ("x", "y")),
    ],
)
def test_axes_of_the_models(model, axes, coordinates):
    geometry = Geometry.read({"model": model, "file": "part.msh"})
    assert geometry.gdim == len(axes)
    assert geometry.coordinates == coordinates
    assert geometry.directions == (*axes, "normal", "all")


@pytest.mark.parametrize(
    "gravity, model, expected",
    [
        ((), "3d", (0.0, 0.0, 0.0)),
        ((), "plane-stress", (0.0, 0.0)),
        ((1.0, 2.0, 3.0), "3d", (1.0, 2.0, 3.0)),
        ((0.0, 0.0, -9.81), "axisymmetric", (0.0, -9.81)),
        ((0.0, -9.81), "axisymmetric", (0.0, -9.81)),
        ((1.0, -9.81, 0.0), "plane-strain", (1.0, -9.81)),
    ],
)
def test_gravity_has_a_number_for_each_direction(gravity, model, expected):
    assert gravity_along(gravity, model) == expected
