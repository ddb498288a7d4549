"""First case files of all processes are accepted, and say what the process says."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import pytest

from castx.case.cad.process_template import process_text
from castx.case.cad.template import NewCase, case_text
from castx.case.processes.names import process_names
from castx.case.processes.plan import plan_of
from castx.case.processes.process import casting_process
from castx.case.reading.read import load_case
from castx.materials.database import database_entry

pytestmark = pytest.mark.serial

HALVES = NewCase(
    "part.step", 0.005, 0.02,
    (("part", 2e-5), ("mould-low", 1e-4), ("mould-high", 1e-4)),
    (("mould-low", "part", 4e-3), ("mould-high", "part", 2e-3), ("mould-high", "mould-low", 5e-3)),
    (("part/outside", 3e-4), ("mould-low/outside", 1e-2), ("mould-high/outside", 1e-2)),
    mould='mould = { box = "20 mm", split = "z = 3 mm" }\n',
    boxes={"part": ((0.0, 0.0, -0.01), (0.06, 0.03, 0.016))},
)  # fmt: skip
CORED = NewCase(
    "part.step", 0.005, None,
    (("casting", 2e-5), ("core", 1e-5), ("chill", 1e-5), ("die", 1e-4)),
    (("casting", "core", 4e-3), ("casting", "die", 2e-3), ("casting", "chill", 5e-4),
     ("core", "die", 1e-4), ("chill", "die", 1e-4)),
    (("die/outside", 1e-2),),
)  # fmt: skip


def case_of(new, name, alloy=None):
    plan = plan_of(casting_process(name), alloy, None, new.modulus(new.castings[0]))
    text = process_text(new, plan, database_entry(plan.alloy).material_class)
    assert "CHOOSE: castx materials" not in text
    return plan, load_case(tomllib.loads(text))


@pytest.mark.parametrize(
    "name", [name for name in process_names() if not casting_process(name).is_strand]
)
def test_halves_of_a_mould_let_go_and_the_casting_cools(name):
    plan, case = case_of(HALVES, name)
    casting, low, high = case.bodies
    assert (casting.material, casting.law) == (plan.alloy, "thermo-elasto-viscoplastic")
    assert casting.temperature.bounds == (plan.pouring, plan.pouring)
    assert low.law == high.law == plan.mould_law
    assert [i.heat.entry for i in case.interfaces[:2]] == [plan.interface] * 2
    removed = [name for stage in case.stages for name in stage.remove]
    assert sorted(removed) == ["mould-high", "mould-low"]
    assert case.stages[0].at == plan.release < case.time.end == plan.end
    assert len(case.stages) == (2 if name == "high-pressure-die" else 1)
    assert [item.type for item in case.boundaries[0].heat] == ["radiation", "convection"]


def test_cores_and_chills_have_interfaces_of_their_own():
    _, case = case_of(CORED, "gravity-die")
    entries = {i.name: i.heat.entry for i in case.interfaces}
    assert entries["casting/core"] == "aluminium-core-sand"
    assert entries["casting/chill"] == "aluminium-chill-copper"
    methods = {i.name: i.contact.method for i in case.interfaces}
    assert methods["core/die"] == methods["chill/die"] == "tied"
    assert set(case.stages[0].remove) == {"core", "chill", "die"}
    _, iron = case_of(CORED, "sand", "GJS-400")
    assert {b.name: b.material for b in iron.bodies}["chill"] == "steel-carbon"


def test_sand_yields_and_its_halves_hold_together():
    _, case = case_of(HALVES, "sand")
    assert [body.law for body in case.bodies[1:]] == ["drucker-prager"] * 2
    assert case.interfaces[2].contact.method == "tied"
    assert case.interfaces[2].heat.closed.table.values[0] == 500.0
    _, cored = case_of(CORED, "sand")
    assert {b.name: b.law for b in cored.bodies}["core"] == "drucker-prager"


@pytest.mark.parametrize(
    "new, alloy, word",
    [
        (CORED, "GJL-250", "no room to swell"),
        (HALVES, "GJL-250", '"rigid" holds it'),  # its top is free
        (CORED, "AlSi7Mg", '"rigid" holds it'),
    ],
)
def test_a_rigid_mould_is_offered_where_the_alloy_has_room(new, alloy, word):
    plan = plan_of(casting_process("sand"), alloy, None, 0.01)
    text = process_text(new, plan, database_entry(alloy).material_class)
    lines = [line for line in text.splitlines() if line.startswith('law = "drucker-prager"')]
    assert lines and all(word in line for line in lines)


def test_a_solid_without_a_label_in_a_mould_that_is_made_is_a_core():
    new = NewCase(
        "part.step", 0.005, 0.02, (("solid-1", 2e-5), ("solid-2", 1e-5), ("mould", 1e-4)),
        (("solid-1", "solid-2", 4e-3), ("solid-1", "mould", 2e-3), ("solid-2", "mould", 1e-4)),
        (("mould/outside", 1e-2),), mould='mould = { box = "20 mm" }\n',
    )  # fmt: skip
    _, case = case_of(new, "gravity-die")
    laws = {body.name: (body.material, body.law) for body in case.bodies}
    assert laws["solid-2"] == ("sand-silica", "drucker-prager")
    assert laws["mould"] == ("steel-H13", "thermo-elastic")
    assert {i.name: i.heat.entry for i in case.interfaces}["solid-1/solid-2"] == (
        "aluminium-core-sand"
    )
    assert case_of(replace(new, margin=None), "gravity-die")[1].bodies[1].material == "steel-H13"


def test_the_outside_of_a_shell_radiates():
    for name, types in (("investment", ["radiation", "convection"]), ("sand", ["convection"])):
        _, case = case_of(CORED, name)
        (boundary,) = (b for b in case.boundaries if b.on == "die/outside")
        assert [heat.type for heat in boundary.heat] == types


def test_nothing_is_tied_to_a_rigid_shell_and_it_stands_second():
    _, case = case_of(CORED, "investment")
    methods = {i.name: i.contact.method for i in case.interfaces}
    assert methods["core/die"] == methods["chill/die"] == "none"
    assert case.bodies[3].law == "rigid"


def test_dimensions_are_those_of_the_part():
    (told,) = HALVES.dimensions(2680.0)
    modulus = 2e-5 / 6.3e-3
    assert told == (
        f"part: 60 × 30 × 26 mm, 20 cm³, 53.6 g, modulus {1e3 * modulus:.2g} mm, walls of "
        f"{2e3 * modulus:.2g} mm in the mean"
    )
    (heavy,) = HALVES.dimensions(1e5)
    assert "2 kg" in heavy


@pytest.mark.parametrize(
    ("factor", "length"), [(1e3, "60 m"), (1e-3, "6e-05 m"), (300.0, ""), (0.05, "")]
)
def test_a_part_that_is_longer_or_shorter_than_any_is_doubted(factor, length):
    low, high = HALVES.boxes["part"]
    box = [factor * x for x in low], [factor * x for x in high]
    _, *doubts = replace(HALVES, boxes={"part": box}).dimensions(2680.0)
    assert len(doubts) == bool(length)
    assert not length or doubts[0].startswith(f"part is {length} long, as no casting is: does ")


@pytest.mark.parametrize("process", ["sand", "gravity-die"])
def test_large_parts_are_told_of_without_powers_of_ten(process):
    large = replace(
        HALVES,
        bodies=tuple((name, 1e4 * volume) for name, volume in HALVES.bodies),
        interfaces=tuple((one, other, 5e2 * area) for one, other, area in HALVES.interfaces),
        surfaces=tuple((on, 5e2 * area) for on, area in HALVES.surfaces),
        boxes={},
    )
    (told,) = large.dimensions(7200.0)
    assert told == "part: 200000 cm³, 1440 kg, modulus 63 mm, walls of 127 mm in the mean"
    plan, _ = case_of(HALVES, process)
    assert "e+" not in process_text(large, plan, "iron") + case_text(large)
