"""The process of a case: its steps, the cases of its stages, its cycles."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from castx.case.reading.read import read_case
from castx.domain.mesh import build_mesh
from castx.domain.pairs.pairing import case_pairs
from castx.errors import CaseError
from castx.process.building import first_change, process_of, stage_cases, step_settings
from castx.process.step_control import MOST_SUBSTEPS, ErrorBounds
from castx.transfer.conductance import ConstantConductance
from tests.coupled_cases import cylinder

pytestmark = pytest.mark.serial



def case_of(**changes: Any):
    data = cylinder({"coupling": {"scheme": "thermal"}}, changes, size=0.01)
    return read_case(data, Path("case.toml"))


def meshed(comm, case):
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    return mesh, case_pairs(mesh, case.interfaces)


@pytest.mark.parametrize(
    "table, key, value, name",
    [
        ("time", "end", 7.0, "end"),
        ("time", "first_step", 0.1, "first"),
        ("time", "largest_step", 3.0, "largest"),
        ("time", "smallest_step", 0.01, "smallest"),
        ("time", "temperature_change", 5.0, "temperature_change"),
        ("time", "solid_fraction_change", 0.02, "solid_fraction_change"),
        ("time", "skin_change", 0.3, "skin_change"),
        ("time", "reject_above", 3.0, "reject_above"),
        ("time", "fixed_step", 0.5, "fixed"),
    ],
)
def test_times_of_a_case_reach_the_step_control(table, key, value, name):
    assert getattr(step_settings(case_of(**{table: {key: value}})), name) == value


def test_a_first_step_that_follows_from_absurd_heat_is_not_nothing():
    data = cylinder({"coupling": {"scheme": "thermal"}, "time": {"end": 7.0}}, size=0.01)
    del data["time"]["first_step"]
    case = read_case(data, Path("case.toml"))
    assert step_settings(case, 0.0).first == pytest.approx(7e-9)
    assert step_settings(case, 2e-8).first == pytest.approx(2e-8)


def test_a_tolerance_of_a_case_reaches_the_step_control():
    def settings(**changes):
        return step_settings(case_of(coupling={"scheme": "iterated"}, time=changes))

    assert settings().tolerance is None
    found = settings(tolerance={"temperature": 2.0, "gap": 1e-6})
    assert found.tolerance == ErrorBounds(2.0, 1e-6, math.inf, MOST_SUBSTEPS)
    assert found.temperature_change == found.solid_fraction_change == math.inf
    assert settings(tolerance={"strain": 1e-5}).tolerance.strain == 1e-5
    assert settings(tolerance={"temperature": 2.0}).tolerance.substeps == 1
    divided = {"tolerance": {"temperature": 2.0}, "heat_substeps": 4}
    assert settings(**divided).tolerance.substeps == 4


def test_a_tolerance_bounds_the_first_step():
    assert first_change(case_of().time) == 20.0
    assert first_change(case_of(time={"tolerance": {"temperature": 2.0}}).time) == 2.0
    assert first_change(case_of(time={"tolerance": {"temperature": 30.0}}).time) == 20.0
    by_gaps = case_of(coupling={"scheme": "iterated"}, time={"tolerance": {"gap": 1e-6}})
    assert first_change(by_gaps.time) == 20.0


def test_times_of_fields_cut_no_steps():
    assert step_settings(case_of(output={"every": 0.5})) == step_settings(case_of())


def test_steps_stop_where_stages_begin():
    case = case_of(stages=[{"at": 2.0, "remove": ["mould"]}])
    assert 2.0 in step_settings(case).stops


def test_a_removed_body_is_in_no_later_stage(comm):
    case = case_of(stages=[{"at": 2.0, "remove": ["mould"]}])
    start, later = stage_cases(case, meshed(comm, case)[0])
    assert [body.name for body in start.bodies] == ["casting", "mould"]
    assert [body.name for body in later.bodies] == ["casting"]
    assert len(start.interfaces) == 1 and not later.interfaces


def test_a_process_is_built_with_its_own_laws_stage_by_stage(comm):
    case = case_of(stages=[{"at": 2.0, "remove": ["mould"]}])
    mesh, pairs = meshed(comm, case)
    law = ConstantConductance(123.0)
    process = process_of(case, mesh, pairs, {"casting/mould": law})
    interfaces = process.now.problem.interfaces
    assert 1.0 / interfaces.resistances[0] == pytest.approx(123.0)
    assert process.proceed(2.0, dict)
    assert list(process.now.mesh.bodies) == ["casting"] and not process.now.pairs
    process.destroy()


def test_a_law_without_interface_is_refused(comm):
    case = case_of()
    mesh, pairs = meshed(comm, case)
    with pytest.raises(CaseError, match="a law for the interface 'casting/core'"):
        process_of(case, mesh, pairs, {"casting/core": ConstantConductance(1.0)})


def test_pairs_are_found_once_and_handed_to_every_stage(comm, monkeypatch):
    """Pairs and gaps of heat and of contact are the same arrays."""
    insulated = {"on": "casting/top", "heat": {"type": "insulated"}}
    stages = [{"at": 2.0, "boundaries": [insulated]}]
    case = case_of(coupling={"scheme": "iterated"}, stages=stages)
    mesh, pairs = meshed(comm, case)

    def again(*_):
        raise AssertionError("node pairs are computed once more")

    monkeypatch.setattr("castx.equilibrium.problem.pairs_of", again)
    process = process_of(case, mesh, pairs)
    for _ in range(2):
        problem = process.now.problem
        assert problem.mechanics.pairs[0] is pairs["casting/mould"]
        assert problem.interfaces.described[0].pairs is pairs["casting/mould"]
        process.proceed(2.0, dict)
    process.destroy()
