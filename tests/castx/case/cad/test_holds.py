"""Which parts of a mould that is made need frames, and how stiff those are."""

from __future__ import annotations

import pytest

from castx.case.cad.holds import frame_clamp, frame_stiffness, frame_text, held_bodies, joined
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.materials.material import Material

pytestmark = pytest.mark.serial

VOLUMES = {"low": 1e-4, "plug": 3e-5, "high": 2e-4}
TOUCHING = [("box", "low"), ("box", "high"), ("box", "plug"), ("high", "low")]


def test_a_loose_plug_and_the_largest_part_of_its_mould():
    assert held_bodies(VOLUMES, TOUCHING, ("box", *VOLUMES)) == ("high", "plug")
    lone = {"low": 1e-4, "plug": 3e-4}
    assert held_bodies(lone, TOUCHING, lone) == ("plug", "low")


def test_things_hang_together_by_their_links():
    """Directly or by others, whatever the order; a thing without a link is alone."""
    found = joined("abcdef", ["ab", "cd", "ba", "bd", "ee"])
    assert sorted("".join(sorted(group)) for group in found) == ["abcd", "e", "f"]
    assert joined((), []) == []


@pytest.mark.parametrize(
    "volumes, touching, free",
    [
        (VOLUMES, [*TOUCHING, ("low", "plug")], VOLUMES),
        (VOLUMES, TOUCHING, ("low", "high")),
        (VOLUMES, TOUCHING, ("plug",)),
        ({"low": 1e-4}, TOUCHING, VOLUMES),
        ({}, [], ()),
    ],
    ids=["tied", "nothing to hang it at", "nor the mould", "one part", "no mould"],
)
def test_no_frame(volumes, touching, free):
    assert held_bodies(volumes, touching, free) == ()


def test_a_frame_is_a_hundredth_as_stiff_as_the_body():
    steel = find_material("steel-H13", {})
    stiffness = frame_stiffness(steel, 20.0, 1e-3)
    assert stiffness == pytest.approx(0.01 * steel.young_modulus(20.0) * 0.1, rel=0.05)
    text = frame_text("steel-H13", 20.0, 1e-3)
    assert text.startswith(frame_clamp(stiffness) + "      # hung on a frame")
    assert frame_clamp(1.3e8) == 'clamp = { stiffness = "130 kN/mm", direction = "all" }'
    assert frame_stiffness(without_modulus(), 20.0, 1e-3) is None


def without_modulus() -> Material:
    bare = MaterialDescription.read({"density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0})
    return Material("bare", bare)
