"""Declarations of generators: complete or refused, with examples that suit their models."""

from dataclasses import replace

import pytest

from castx.meshes.generators.box_in_mould import GENERATOR as BOX
from castx.meshes.generators.core_in_ring import GENERATOR as RING
from castx.meshes.generators.declaration import (
    COMMON_ARGUMENTS,
    LENGTH,
    MODELS,
    PLANE_MODELS,
    SIDES,
    Argument,
    ArgumentKind,
    Generator,
)
from castx.meshes.generators.slab import GENERATOR as SLAB
from castx.meshes.generators.slab import slab

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("lacking", ["summary", "models", "arguments", "surfaces", "extents"])
def test_a_generator_that_leaves_something_out_is_refused(lacking):
    with pytest.raises(TypeError, match=f"^the generator 'slab' declares no {lacking}$"):
        replace(SLAB, **{lacking: None if lacking == "extents" else type(getattr(SLAB, lacking))()})


def test_arguments_have_a_meaning_and_an_example():
    for unclear in (LENGTH, LENGTH.of("radius", None), LENGTH.of("", 0.1)):
        with pytest.raises(TypeError, match="declares no meaning or example of 'radius'"):
            replace(SLAB, arguments={"radius": unclear})
    text = "no summary, no models, no arguments, no surfaces, no extents"
    with pytest.raises(TypeError, match=text):
        Generator(mesh=slab)
    assert all(a.meaning and a.example is not None for a in COMMON_ARGUMENTS.values())


def test_the_name_is_that_of_the_function():
    assert SLAB.name == "slab" and SLAB.mesh is slab


def test_an_argument_of_a_kind():
    depth = LENGTH.of("extent in z", 0.2, needed=("3d",))
    assert depth == Argument(ArgumentKind.LENGTH, "extent in z", 0.2, ("3d",), MODELS)
    assert LENGTH.of("radius", 0.1).needed == MODELS


def test_examples_have_the_arguments_and_the_sides_of_a_model():
    sides = SIDES.of("of the casting", (0.3, 0.2, 0.1))
    assert [sides.example_in(model) for model in ("3d", *PLANE_MODELS)] == [
        [0.3, 0.2, 0.1], *[[0.3, 0.2]] * 3,
    ]  # fmt: skip
    assert "depth" in SLAB.example("3d") and "depth" not in SLAB.example("plane-strain")
    assert "height" in RING.example("axisymmetric") and "height" not in RING.example("plane-strain")
    assert RING.example("3d")["sector"] == "quarter"
    assert BOX.example("plane-stress")["lid"] is False


def test_outer_dimensions_are_those_of_the_arguments():
    box = {"box": (0.1, 0.06), "wall": 0.02}
    assert BOX.outer_dimensions(box) == pytest.approx([0.14, 0.08])
    assert BOX.outer_dimensions({**box, "lid": True}) == pytest.approx([0.14, 0.1])
