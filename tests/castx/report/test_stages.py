"""Stages as `castx check` and the report tell them."""

from __future__ import annotations

import re
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from castx.case.boundaries import Boundary
from castx.case.reading.read import load_case
from castx.case.stages import Stage
from castx.report.stages import cycle_text, process_rows, stage_table

pytestmark = pytest.mark.serial

DEMOS = Path(__file__).parents[3] / "demos"


def shown(table):
    stream = StringIO()
    Console(file=stream, width=120).print(table)
    return [line.strip() for line in stream.getvalue().splitlines()]


def test_the_table_tells_bodies_and_changes_of_each_stage():
    case = load_case(DEMOS / "stages.toml")
    cold = case.model_copy(update={"bodies": case.bodies[:1]})
    lines = shown(stage_table(case, [case, cold, cold]))
    text = "\n".join(lines)
    assert any(line.split() == ["0", "0", "s", "casting,", "core"] for line in lines)
    assert "120 s" in text and "without core" in text
    assert "casting/core: convection" in text
    assert "casting/base: displacement" in text
    assert "force to draw core, friction 0.3" in text
    assert "spray on casting" in text


def test_the_table_tells_loads_and_what_a_stage_lifts():
    case = load_case(DEMOS / "stages.toml")
    given = {"pressure": 1e5, "clamp": {"force": 5e3}, "displacement": "free"}
    for conditions, text in (
        (given, "casting/top: displacement free, pressure, clamp"),
        ({"clamp": "free"}, "casting/top: clamp free"),
    ):
        boundary = Boundary.read({"on": "casting/top", **conditions})
        stage = Stage.read({"at": 1.0, "boundaries": [boundary]})
        changed = case.model_copy(update={"stages": (stage,)})
        assert any(line.endswith(text) for line in shown(stage_table(changed, [case, case])))


def test_cycles_are_counted_to_the_end_of_the_run():
    case = load_case(DEMOS / "die_cycles.toml")
    text = cycle_text(case)
    assert text.startswith("8 cycles of ") and "casting new in each" in text
    length, end = (float(part.split()[0]) for part in re.split(" of | at ", text)[1:])
    assert end == pytest.approx(8 * length)


def event(**content):
    return {"time": 10.0, "cycle": 1, **content}


def test_stages_are_told_once():
    events = [
        event(stage=1, bodies=["casting", "mould"]),
        event(stage=2, bodies=["casting"], time=20.0),
        event(stage=1, bodies=["casting", "mould"], cycle=2),
    ]
    assert list(process_rows(events)) == [
        ("stage 1", "from 10 s: casting, mould"),
        ("stage 2", "from 20 s: casting"),
    ]


def test_the_last_force_to_draw_a_body_counts():
    forces = [{"force": f, "friction": 0.3, "normal": f / 0.3} for f in (300.0, 600.0)]
    events = [event(ejection={"core": found}, time=10.0 * n) for n, found in enumerate(forces)]
    ((name, text),) = process_rows(events)
    assert name == "force to draw core"
    assert text.startswith("about 600 N at 10 s: friction 0.3 times normal forces of 2000 N")


@pytest.mark.parametrize(
    ("periodic", "distance", "expected"),
    [
        ((False, True, True), 0.2, "periodic since cycle 2; cycle 3 ended within 0.5 K of the one "
         "before, about 0.2 K from the periodic state"),
        ((False, True, False), None, "not periodic yet; cycle 3 ended within 0.5 K of the one "
         "before"),
    ],
)  # fmt: skip
def test_the_way_to_the_periodic_state(periodic, distance, expected):
    events = [
        event(cycle=number, change=0.5, periodic=found, distance=distance)
        for number, found in enumerate(periodic, start=1)
    ]
    assert list(process_rows([event(change=None), *events])) == [("cycles", expected)]
