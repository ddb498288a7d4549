"""Stages that cannot be run are refused when the case is read, with key, value and cure."""

from pathlib import Path
from typing import Any

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")
AIR = {"type": "convection", "coefficient": 20, "ambient": 25}
SPRAY: dict[str, Any] = {"coefficient": [[0, 2000], [3, 0]], "ambient": "30 degC"}
OPENING: dict[str, Any] = {"at": "60 s", "remove": ["mould"]}
BARE: dict[str, Any] = {**OPENING, "boundaries": [{"on": "casting/mould", "heat": AIR}]}
CYCLES = {"at": "90 s", "repeat": 10, "renew": ["casting"]}
SHOWER = {"at": 70, "spray": {"on": ["casting"], **SPRAY}}
EJECTION = {"at": "60 s", "remove": ["casting"], "eject": 0.2, "spray": SPRAY}


def stages(*items, **changes):
    return cylinder(stages=list(items), **changes)


@pytest.mark.parametrize(
    "items",
    [
        [OPENING],
        [BARE, {"at": 70, "spray": {"on": ["casting"], **SPRAY}}],
        [{**OPENING, "eject": {"mould": 0.3}}],
        [{"at": "1 min", "boundaries": [{"on": "mould/base", "displacement": "free"}]}],
        [EJECTION, CYCLES],
        [{**EJECTION, "repeat": 3, "renew": ["casting"], "periodic": "0.5 K"}],
        [{"at": "90 s", "repeat": 2}],
        [{"at": "50 s", "boundaries": [{"on": "casting/top", "pressure": 1e5}]}],
        [{"at": "50 s", "boundaries": [{"on": "mould/top", "clamp": {"force": "5 kN"}}]}],
        [{"at": "50 s", "boundaries": [{"on": "mould/top", "clamp": "free"}]}],
    ],
)
def test_accepted(items):
    assert len(read_case(stages(*items), FILE).stages) == len(items)


REFUSED = [
    ([{"at": "60 s"}], "stages[0]: says nothing; give remove, boundaries, spray, eject or repeat"),
    ([{**OPENING, "at": 0}], "stages[0].at = 0: must be positive"),
    ([{**OPENING, "at": "95 s"}], 'stages[0].at = "95 s": begins when the case ends already'),
    ([{**OPENING, "at": "90 s"}], "begins when the case ends already (time.end, 90 s)"),
    ([{**CYCLES, "at": "91 s"}], "the cycle would end after the case does (time.end, 90 s)"),
    ([OPENING, {**SHOWER, "at": 50}], "stages[1].at = 50: must be later than the stage before i"),
    ([{**OPENING, "remove": ["mold"]}], 'remove[0] = "mold": unknown body; known: casting, mould'),
    ([{**OPENING, "remove": ["mould", "mould"]}], "remove[1] = \"mould\": is there already"),
    ([OPENING, {**OPENING, "at": 70}], 'stages[1].remove[0] = "mould": is gone already; still th'),
    ([{**OPENING, "remove": ["mould", "casting"]}], "leaves no body; keep one at least"),
    ([{**CYCLES, "renew": ["cast"]}], 'renew[0] = "cast": unknown body; known: casting, mould'),
    ([{**OPENING, "renew": ["casting"]}], "stages[0].renew = [\"casting\"]: belongs to cycles"),
    ([{**OPENING, "periodic": 1}], "stages[0].periodic = 1: belongs to cycles; give repeat"),
    ([{**OPENING, "repeat": 2}, SHOWER], "stages[0].repeat = 2: only the last stage can ask"),
    ([{**CYCLES, "repeat": 0}], "repeat = 0: a whole number from 1 to 10000 is needed"),
    (
        [{**OPENING, "boundaries": [{"on": "mould/outside", "heat": AIR}]}],
        "boundaries[0].on = \"mould/outside\": the body 'mould' is removed by then; there are",
    ),
    (
        [{"at": 60, "boundaries": [{"on": "casting/mould", "heat": AIR}]}],
        "'mould' still touches 'casting' there; remove it, or change the interface",
    ),
    (
        [{**OPENING, "boundaries": [{"on": "casting/mold", "heat": AIR}]}],
        "no surface 'mold'; 'casting' has: base, top, symmetry-x, symmetry-y, mould (did you mean",
    ),
    (
        [{**OPENING, "boundaries": [{"on": "casting/top", "displacement": {"x": 0}}]}],
        "boundaries[0].displacement.x = 0: directions of the model 'axisymmetric': r, z, normal",
    ),
    (
        [{**BARE, "boundaries": BARE["boundaries"] * 2}],
        "boundaries[1].heat: 'casting/mould' has it already in this stage; put both in one entry",
    ),
    (
        [{"at": 60, "boundaries": [{"on": "mould/top", "clamp": {"force": 1}}] * 2}],
        "boundaries[1].clamp: 'mould/top' has it already in this stage; put both in one entry",
    ),
    (
        [{"at": 60, "boundaries": [{"on": "mould/symmetry-x", "clamp": {"force": 1}}]}],
        "stages[0].boundaries[0].clamp: the body goes on behind a symmetry plane",
    ),
    ([{**OPENING, "eject": -1}], "stages[0].eject = -1: a coefficient of friction is needed, mus"),
    ([{**OPENING, "eject": {}}], "stages[0].eject: names no body; give coefficients of friction"),
    ([{"at": 60, "eject": 0.3}], "the stage removes no body to draw; name it in remove, or here"),
    ([{"at": 60, "eject": {"core": 0.3}}], "no such body at this time; there are: casting, mould"),
    ([{"at": 60, "eject": {"mould": "x"}}], "stages[0].eject.mould = \"x\": "),
    (
        [{**BARE, "spray": {"on": ["casting/mould"], **SPRAY}}],
        "boundaries of this stage give it heat already; leave out one",
    ),
    ([{**OPENING, "spray": {"on": ["mould"], **SPRAY}}], "no such body then; there are: casting"),
    ([{"at": 60, "spray": {"coefficient": 9}}], "stages[0].spray.ambient: missing"),
    ([{"at": 60, "spray": {**SPRAY, "colour": 1}}], "spray.colour = 1: unknown key; known keys:"),
]


@pytest.mark.parametrize(("items", "message"), REFUSED, ids=[text[:40] for _, text in REFUSED])
def test_refused(items, message):
    with pytest.raises(CaseError) as caught:
        read_case(stages(*items), FILE)
    assert message in str(caught.value)
    assert "problems" not in str(caught.value), "one mistake, one message"


def test_ejection_needs_contact():
    for change in (
        {"coupling__scheme": "thermal"},
        {"interfaces__0__contact": {"method": "none"}},
    ):
        with pytest.raises(CaseError, match=r"stages\[0\].eject"):
            read_case(stages({**OPENING, "eject": {"mould": 0.3}}, **change), FILE)


def test_a_new_casting_cannot_be_tied_to_an_old_mould():
    tied = {"interfaces__0__contact": {"method": "tied"}}
    with pytest.raises(CaseError, match=r"renew.*tied to 'mould', which keeps its shape"):
        read_case(stages(CYCLES, **tied), FILE)
    both = {**CYCLES, "renew": ["casting", "mould"]}
    assert read_case(stages(both, **tied), FILE).stages[0].renew == ("casting", "mould")


def test_only_stages_lift_what_held():
    with pytest.raises(CaseError, match=r"boundaries\[1\].displacement.*only a stage lifts"):
        read_case(cylinder(boundaries__1__displacement="free"), FILE)


def test_rigid_bodies_feel_no_load_in_a_stage():
    pressed = {"at": 60, "boundaries": [{"on": "mould/outside", "pressure": 1e5}]}
    with pytest.raises(CaseError, match=r"stages\[0\].boundaries\[0\].pressure.*is rigid"):
        read_case(stages(pressed, bodies__1__law="rigid"), FILE)
