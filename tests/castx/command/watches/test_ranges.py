"""What a run leaves the ranges of, said once for each material."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.reading.read import load_case, read_case
from castx.command.watches.ranges import (
    RangeWatch,
    coldest_possible,
    material_remarks,
    material_warnings,
    used_properties,
)
from castx.materials.description import MaterialDescription
from castx.materials.inelastic import FLOW_RULES
from castx.materials.lookup import find_material
from tests.castx.case.cad.test_process_template import CORED, HALVES
from tests.castx.case.cad.test_process_template import case_of as new_case_of
from tests.castx.case_data import cylinder
from tests.castx.fakes import FakeSnapshot, Formula, cylinder_mesh
from tests.partitions import PARTITION, on_the_last

LISTENED = "castx.command.watches.ranges"
HEAT = {"heat_capacity", "conductivity"}
ELASTIC = {"young_modulus", "poisson_ratio", "expansion"}
FLOW = {"yield_stress", "hardening", "kinematic_hardening"}


FROST = {"type": "convection", "coefficient": 10, "ambient": -50}


def case_of(**changes) -> Case:
    usual = {
        "bodies__0__material": "AlSi7Mg", "bodies__1__material": "steel-H13",
        "boundaries__0__heat": FROST,
    }  # fmt: skip
    return read_case(cylinder(**{**usual, **changes}), Path("case.toml"))


def snapshots(comm, *temperatures: tuple[float, float]) -> Iterator[FakeSnapshot]:
    """Yield states whose mould is as hot as given, from its base to its top."""
    mesh = cylinder_mesh(comm)
    for step, ends in enumerate(temperatures):
        formulas: dict[str, Formula] = {"temperature": partial(rising, *ends)}
        yield FakeSnapshot(time=float(step), step=step, mesh=mesh, formulas=formulas)


def rising(low: float, high: float, x: FloatArray) -> FloatArray:
    return np.asarray(low + (high - low) * x[:, 1] / 0.04)


@pytest.mark.ranks
def test_a_material_is_named_once_when_it_leaves_its_range(comm, heard):
    watch = RangeWatch(case_of(), comm)
    for snapshot in snapshots(comm, (200, 590), (200, 605), (200, 650), (15, 900)):
        watch.check(snapshot)
    if comm.rank > 0:
        assert heard == []
        return
    mould, casting = heard
    assert mould.startswith("at t = 1 s steel-H13 (mould) is at 200 to 605 °C, outside what")
    assert "heat_capacity, young_modulus, poisson_ratio, expansion (20 to 600 °C);" in mould
    # The melt has data up to 800 °C, the solid from 20 °C on.
    assert casting.startswith("at t = 3 s AlSi7Mg (casting) is at 15 to 900 °C")
    assert "heat_capacity.liquid, conductivity.liquid (613 to 800 °C)" in casting
    assert "heat_capacity.solid" in casting and "yield_stress" not in casting


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("ends", "warned"),
    [((19.6, 200), 0), ((19.4, 200), 1), ((19.6, 19.6), 0), ((19.4, 19.4), 1), ((200, 600.4), 0),
     ((20, 20), 0), ((600, 600), 0), ((600.4, 600.4), 0), ((600.6, 600.6), 1),
     ((18.9, 420), 0), ((18.7, 420), 1),
     ((200, 601.4), 1), ((700, 700), 1)],
)  # fmt: skip
def test_a_part_of_a_kelvin_outside_is_none(comm, heard, ends, warned):
    watch = RangeWatch(case_of(), comm)
    for snapshot in snapshots(comm, ends):
        watch.check(snapshot)
    assert sum("steel-H13" in text for text in heard) == warned * (comm.rank == 0)


@pytest.mark.ranks
def test_the_end_says_for_how_long_how_far_and_where(comm, heard):
    """The mould is 40 mm high: of (200, 640) a tenth is beyond 600 °C, and 1 s to 3 s are."""
    with RangeWatch(case_of(), comm) as watch:
        for snapshot in snapshots(comm, (200, 590), (200, 605), (200, 640), (200, 610), (200, 500)):
            watch.check(snapshot)
    if comm.rank > 0:
        assert heard == []
        return
    (_, end) = heard
    assert end.startswith(
        "steel-H13 has left its data for 3 s, by 40 K at most (in mould), in no more than "
    )
    share = float(re.search(r"than ([0-9.]+) % of the nodes", end)[1])
    assert 5.0 < share < 20.0


@pytest.mark.serial
def test_nothing_is_said_at_the_end_of_what_has_not_left_its_data(comm, heard):
    with RangeWatch(case_of(), comm) as watch:
        for snapshot in snapshots(comm, (200, 590)):
            watch.check(snapshot)
    assert heard == []


def told(case):
    """Return warnings and remarks on the material of the mould."""
    found = material_warnings(case), material_remarks(case)
    return [[text for text in texts if text.startswith("steel-H13")] for texts in found]


@pytest.mark.serial
def test_a_die_that_hot_metal_takes_no_farther_is_no_warning():
    for new, names in ((HALVES, "mould-low, mould-high"), (CORED, "die")):
        warned, (remark,) = told(new_case_of(new, "gravity-die")[1])
        assert warned == []
        assert remark.startswith(f"steel-H13 ({names}) has less data than the case has")
        assert "young_modulus, poisson_ratio, expansion (20 to 600 °C)" in remark


@pytest.mark.serial
@pytest.mark.parametrize(
    "changes",
    [
        {"bodies__0__temperature": 1200},
        {"bodies__1__temperature": 610},
        {"bodies__1__heat_source": 1e6, "bodies__0__temperature": 700},
        {"boundaries__0__heat": {**FROST, "ambient": 650}},
        {"bodies__0__material": "steel-H13", "bodies__0__temperature": 700},
    ],
    ids=["hotter metal", "a hot die", "a heated die", "hot gas", "the same material"],
)
def test_a_die_that_leaves_its_data_is_warned_of(changes):
    (warning,), remarks = told(case_of(**changes))
    assert remarks == [] and "has data for less than the temperatures of the case" in warning
    assert warning.endswith("a run says whether it gets there, how far and for how long")


@pytest.mark.serial
@pytest.mark.parametrize(
    ("heat", "source", "coldest"),
    [
        ({"type": "insulated"}, None, 200.0),
        ({**FROST, "ambient": 15.0}, None, 15.0),
        ({**FROST, "ambient": 15.0}, 1e6, 15.0),
        ({**FROST, "ambient": 15.0}, [[0, 1e6], [5, -1e6]], -np.inf),
        ({"type": "flux", "value": -1e4}, None, -np.inf),
    ],
)
def test_nothing_is_colder_than_what_a_case_names(comm, heard, heat, source, coldest):
    """Nodes of a coarse mesh may be, unless heat is drawn whatever the temperature is."""
    changes = {"boundaries__0__heat": heat}
    if source is not None:
        changes["bodies__1__heat_source"] = source
    case = case_of(**changes)
    assert coldest_possible(case) == coldest
    watch = RangeWatch(case, comm)
    for snapshot in snapshots(comm, (12, 200)):
        watch.check(snapshot)
    assert any("steel-H13" in text for text in heard) == (coldest < 20.0)


@pytest.mark.serial
def test_stages_name_temperatures_too():
    assert coldest_possible(load_case("demos/stages.toml")) == 25.0


@pytest.mark.ranks
def test_the_first_rank_speaks_though_it_has_no_cells(comm, heard, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    watch = RangeWatch(case_of(), comm)
    for snapshot in snapshots(comm, (200, 605)):
        watch.check(snapshot)
    assert ["is at 200 to 605 °C" in text for text in heard] == [True] * (comm.rank == 0)


@pytest.mark.ranks
def test_bodies_of_one_material_share_their_warning(comm, heard):
    changes = {"bodies__0__material": "steel-H13", "coupling__scheme": "thermal"}
    watch = RangeWatch(case_of(**changes), comm)
    for snapshot in snapshots(comm, (200, 620), (200, 640)):
        watch.check(snapshot)
    assert len(heard) == (comm.rank == 0)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("law", "changes", "expected"),
    [
        ("thermo-elastic", {}, HEAT | ELASTIC | {"liquid"}),
        ("thermo-elastic", {"coupling__scheme": "thermal"}, HEAT),
        ("thermo-elastic", {"coupling__scheme": "mechanical"}, ELASTIC | {"liquid"}),
        ("thermo-elasto-plastic", {}, HEAT | ELASTIC | FLOW | {"liquid"}),
        (
            "thermo-elasto-viscoplastic",
            {},
            HEAT | ELASTIC | FLOW | {"liquid", "viscosity", "exponent"},
        ),
    ],
)
def test_only_properties_that_the_run_uses_count(law, changes, expected):
    heat = {"interfaces__0__heat": {"law": "none"}} if "mechanical" in changes.values() else {}
    case = case_of(**changes, **heat)
    body = case.bodies[0].model_copy(update={"law": law})
    material = find_material("AlSi7Mg", {}).description
    assert used_properties(case, body, material) == expected


@pytest.mark.serial
def test_norton_flows_without_yield_stress_and_a_solid_mould_without_its_liquid():
    case = case_of()
    norton = MaterialDescription.read(
        {"law": "norton", "coefficient": 1e-30, "exponent": 5, "activation_energy": 1e5}
    )
    mould = case.bodies[1].model_copy(update={"law": "thermo-elasto-viscoplastic"})
    rates = {"coefficient", "exponent", "activation_energy"}
    assert used_properties(case, mould, norton) == HEAT | ELASTIC | rates
    copper = find_material("Cu-pure", {}).description
    assert used_properties(case, case.bodies[1], copper) == HEAT | ELASTIC


@pytest.mark.serial
@pytest.mark.parametrize("law", FLOW_RULES)
def test_a_body_uses_the_keys_of_its_flow_rule(law):
    rule = FLOW_RULES[law]
    case = case_of()
    material = MaterialDescription.read({"law": law, **rule.example})
    mould = case.bodies[1].model_copy(update={"law": "thermo-elasto-viscoplastic"})
    used = HEAT | ELASTIC | {key.name for key in rule.keys} | (FLOW if rule.threshold else set())
    assert used_properties(case, mould, material) == used


@pytest.mark.serial
def test_a_range_is_that_of_the_table_in_a_case_file(comm, heard):
    changes = {"materials__steel__conductivity": [[100, 25], [300, 27]],
               "bodies__1__material": "steel"}  # fmt: skip
    watch = RangeWatch(case_of(**changes), comm)
    for snapshot in snapshots(comm, (100, 300), (100, 301)):
        watch.check(snapshot)
    (message,) = heard
    assert "steel (mould) is at 100 to 301 °C" in message and "conductivity (100 to" in message
    assert np.isfinite(watch._materials["steel"].conductivity(301.0, 1.0))


@pytest.mark.serial
def test_grains_use_their_yield_surface():
    sand = MaterialDescription.read({"granular": {"cohesion": 1e6, "friction_angle": 30.0}})
    case = case_of()
    mould = case.bodies[1].model_copy(update={"law": "drucker-prager"})
    assert used_properties(case, mould, sand) == HEAT | ELASTIC | {"granular"}
    assert used_properties(case, case.bodies[1], sand) == HEAT | ELASTIC
    rigid = case.bodies[1].model_copy(update={"law": "rigid"})
    assert used_properties(case, rigid, sand) == HEAT
