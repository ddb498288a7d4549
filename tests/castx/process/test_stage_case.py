"""What a case asks for during a stage: bodies, conditions and sprayed surfaces."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.boundaries import Boundary
from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.process.stage_case import replaced, sprayed_surfaces, stage_case
from tests.coupled_cases import cylinder

pytestmark = pytest.mark.serial

AIR = {"type": "convection", "coefficient": 50.0, "ambient": 20.0}
SPRAY = {"coefficient": 3e3, "ambient": 20.0}
SURFACES = {
    "casting": ("mould", "top", "base", "symmetry-axis"),
    "mould": ("casting", "outside", "base"),
}


def case_of(*stages, **changes):
    return read_case(cylinder({"stages": list(stages), **changes}), Path("case.toml"))


def test_boundaries_replace_those_of_the_same_kind():
    def given(**conditions) -> Boundary:
        return Boundary.read({"on": "casting/top", **conditions})

    old = [given(heat=AIR), given(displacement={"normal": 0})]
    (hot,) = replaced(old, [given(heat={"type": "insulated"})])
    assert hot.heat[0].type == "insulated" and hot.displacement == old[1].displacement
    (free,) = replaced(old, [given(displacement="free")])
    assert free.displacement == () and free.heat == old[0].heat
    (loaded,) = replaced(old, [given(pressure=1e5)])
    assert loaded.pressure is not None and loaded.heat and loaded.displacement


def test_a_stage_holds_what_is_left_and_keeps_earlier_conditions():
    case = case_of(
        {"at": 2.0, "boundaries": [{"on": "casting/top", "heat": AIR}]},
        {"at": 3.0, "remove": ["mould"]},
    )
    start, cooled, bare = (stage_case(case, number, SURFACES) for number in range(3))
    assert start.boundaries == tuple(replaced(case.boundaries, []))
    assert [b.on for b in cooled.boundaries] == ["casting/base", "mould/base", "casting/top"]
    assert [b.on for b in bare.boundaries] == ["casting/base", "casting/top"]
    assert [body.name for body in bare.bodies] == ["casting"] and bare.interfaces == ()
    assert len(case.bodies) == 2  # the case itself stays as it is


def test_conditions_of_one_surface_may_stand_in_several_entries():
    """The second entry had taken the place of the first, whose heat was lost without a word."""
    case = case_of(
        boundaries=[
            {"on": "mould/outside", "heat": AIR},
            {"on": "mould/outside", "displacement": {"r": 0.0}},
        ]
    )
    (held,) = stage_case(case, 0, SURFACES).boundaries
    assert held.heat == case.boundaries[0].heat
    assert held.displacement == case.boundaries[1].displacement


def test_surfaces_that_are_clamped_in_some_stage_are_known_in_all():
    """Free of force before and after, along the direction of the clamp, for equal columns."""
    pressed = {"force": 5e3, "stiffness": 1e9, "direction": "z"}
    case = case_of(
        {"at": 1.0, "boundaries": [{"on": "mould/top", "clamp": pressed}]},
        {"at": 2.0, "boundaries": [{"on": "mould/top", "heat": AIR}]},
        {"at": 3.0, "boundaries": [{"on": "mould/top", "clamp": "free"},
                                   {"on": "mould/outside", "clamp": "free"}]},
        {"at": 4.0, "remove": ["mould"]},
    )  # fmt: skip
    found = []
    for number in range(4):
        by_name = {b.on: b for b in stage_case(case, number, SURFACES).boundaries}
        clamp = by_name["mould/top"].clamp
        assert clamp is not None and clamp.direction == "z"
        found.append((clamp.force(0.0), clamp.stiffness))
        assert by_name["mould/base"].clamp is None
    assert found == [(0.0, None), (5e3, 1e9), (5e3, 1e9), (0.0, None)]
    assert by_name["mould/outside"].clamp is None  # nothing ever pressed there
    assert by_name["mould/top"].heat
    last = stage_case(case, 4, SURFACES)
    assert [b.on for b in last.boundaries] == ["casting/base"]


@pytest.mark.parametrize(
    "on, wet",
    [
        ([], ["casting/mould"]),
        (["casting"], ["casting/mould", "casting/top", "casting/base"]),
        (["casting/top"], ["casting/top"]),
        (["casting/top", "casting"], ["casting/top", "casting/mould", "casting/base"]),
    ],
)
def test_a_spray_wets_bare_surfaces_or_those_named(on, wet):
    case = case_of({"at": 2.0, "remove": ["mould"], "spray": {**SPRAY, "on": on}})
    assert sprayed_surfaces(case.stages[0], 0, ["casting"], SURFACES) == wet
    heats = {b.on: b.heat for b in stage_case(case, 1, SURFACES).boundaries if b.heat}
    assert set(heats) == set(wet)
    assert all(heat.coefficient.table(0.0) == 3e3 for (heat,) in heats.values())


def test_a_condition_of_the_same_stage_stands_before_its_spray():
    own = {"on": "casting/mould", "heat": AIR}
    case = case_of(
        {"at": 2.0, "remove": ["mould"], "boundaries": [own],
         "spray": {**SPRAY, "on": ["casting"]}}
    )  # fmt: skip
    wet = sprayed_surfaces(case.stages[0], 0, ["casting"], SURFACES)
    assert wet == ["casting/top", "casting/base"]


def test_a_spray_without_surface_is_refused():
    case = case_of({"at": 2.0, "spray": SPRAY})
    with pytest.raises(CaseError, match=r"stages\[0\]\.spray: no removed body has left"):
        stage_case(case, 1, SURFACES)
