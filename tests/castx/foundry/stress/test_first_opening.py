"""First opening of two plates that are heated, then cooled through their stress-free temperature.

Held at their far ends and sides and free above, plane strain: the gap of a plate of the length L is
(1 + ν) α ΔT L as soon as it is colder than where it was free of stress.
"""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.run import run
from castx.domain.mesh import build_mesh
from castx.errors import CaseError
from castx.foundry.stress.first_opening import (
    FIRST_OPENING,
    FirstOpenings,
    first_openings_of,
)
from castx.input.toml_text import parse_toml
from castx.results.reading import Results
from castx.results.states.snapshot import ProcessState
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh
from tests.partitions import PARTITION, on_the_last

LENGTH, EXPANSION, POISSON, RATE, STEP = 0.1, 2.2e-5, 0.25, 10.0, 0.3
OPENING = 2 * LENGTH * EXPANSION * (1 + POISSON) * RATE  # m/s, both plates
CASE = f"""
[geometry]
generator = "two_slabs"
model = "plane-strain"
length = {LENGTH}
mould_length = {LENGTH}
width = 0.05
size = 0.025
[materials.metal]
young_modulus = 65e9
poisson_ratio = {POISSON}
expansion = {EXPANSION}
stress_free = 100
[[bodies]]
name = "casting"
material = "metal"
temperature = 110
temperature_history = [[0, 110], [2, 90]]
[[bodies]]
name = "mould"
material = "metal"
temperature = 110
temperature_history = [[0, 110], [2, 90]]
[[interfaces]]
bodies = ["casting", "mould"]
[[boundaries]]
on = "casting/far"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "mould/far"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "casting/bottom"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "mould/bottom"
displacement = {{ normal = 0 }}
[time]
end = 2.1
fixed_step = {STEP}
first_step = {STEP}
largest_step = {STEP}
[coupling]
scheme = "mechanical"
[output]
fields = ["gap", "first_opening"]
"""


@pytest.fixture(scope="module")
def folder(written_case):
    return written_case(CASE).parent


def opened(folder, comm, name, *overrides):
    """Return when the interface opened, from run.json and the field."""
    run(folder / "case.toml", list(overrides), output=folder / name, comm=comm)
    results = Results(folder / name)
    found = results.field(FIRST_OPENING, "casting")
    times = found.values[np.isfinite(found.values)]
    assert len(times) == 3  # nodes on the interface
    said = results.record["openings"]["casting/mould"]
    assert said["first"] == pytest.approx(times.min(), rel=1e-12)
    assert said["opened_fraction"] == 1.0
    assert np.isnan(results.field(FIRST_OPENING, "mould").values).all()
    return times


@pytest.mark.ranks
def test_it_opens_in_the_step_that_crosses_the_stress_free_temperature(comm, folder):
    times = opened(folder, comm, "usual")
    assert (times > 3 * STEP).all() and (times <= 4 * STEP).all()


@pytest.mark.ranks
def test_a_larger_threshold_is_passed_later(comm, folder):
    """Once it is open the gap grows steadily, and the time is exact."""
    threshold = 0.4 * OPENING
    times = opened(folder, comm, "later", f"foundry.opening_gap={threshold!r}")
    np.testing.assert_allclose(times, 1.4, rtol=1e-6)


def test_it_goes_on_after_a_break(comm, folder):
    whole = opened(folder, comm, "whole")
    run(folder / "case.toml", ["time.end=0.9"], output=folder / "parts", comm=comm)
    assert Results(folder / "parts").record["openings"]["casting/mould"]["first"] is None
    run(folder / "case.toml", output=folder / "parts", comm=comm, restart=True)
    found = Results(folder / "parts").field(FIRST_OPENING, "casting").values
    np.testing.assert_allclose(found[np.isfinite(found)], whole, rtol=1e-9)


def test_pairs_open_one_after_the_other_and_stay_opened(comm):
    mesh = cylinder_mesh(comm)
    pairs = casting_pairs(mesh)
    openings = FirstOpenings(mesh, pairs, 1e-6)

    def follow(time, gap, *renewed):
        process = ProcessState(renewed=frozenset(renewed))
        state = FakeSnapshot(time, 0, mesh, pairs, {"gap": gap}, process=process)
        openings.update(state)
        return openings.field("casting", FIRST_OPENING)

    z = mesh.bodies["casting"].points[:, 1]
    side = np.zeros(len(z), dtype=bool)
    side[mesh.bodies["casting"].surface_nodes("mould")] = True
    assert np.isnan(follow(0.0, lambda x: np.zeros(len(x)))).all()
    first = follow(1.0, lambda x: np.where(x[:, 1] > 0.021, 4e-6, 0.0))
    assert np.array_equal(np.isfinite(first), side & (z > 0.021))
    np.testing.assert_allclose(first[side & (z > 0.021)], 0.25)
    second = follow(3.0, lambda x: np.where(x[:, 1] > 0.021, 0.0, 2e-6))
    np.testing.assert_allclose(second[side & (z > 0.021)], 0.25)
    np.testing.assert_allclose(second[side & (z <= 0.021)], 2.0)
    assert np.isnan(follow(4.0, lambda x: np.zeros(len(x)), "casting")).all()
    assert follow(5.0, lambda x: np.full(len(x), 2e-6))[side] == pytest.approx(4.5)


@pytest.mark.ranks
def test_all_ranks_know_when_pairs_of_one_opened(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    mesh = cylinder_mesh(comm)
    pairs = casting_pairs(mesh)
    openings = FirstOpenings(mesh, pairs, 1e-6)
    for time, gap in ((0.0, 0.0), (1.0, 4e-6)):
        formulas = {"gap": lambda x, gap=gap: np.full(len(x), gap)}
        openings.update(FakeSnapshot(time, 0, mesh, pairs, formulas))
    found = openings.described()["casting/mould"]
    assert found == {"first": pytest.approx(0.25), "opened_fraction": 1.0}


@pytest.mark.serial
def test_what_is_open_from_the_start_opens_then(comm):
    mesh = cylinder_mesh(comm)
    openings = FirstOpenings(mesh, casting_pairs(mesh), 1e-6)
    wide = {"gap": lambda x: np.full(len(x), 1e-3)}
    openings.update(FakeSnapshot(7.0, 0, mesh, casting_pairs(mesh), wide))
    assert openings.described()["casting/mould"] == {"first": 7.0, "opened_fraction": 1.0}


@pytest.mark.serial
def test_a_run_without_mechanics_has_none():
    content = parse_toml(CASE)
    content["coupling"]["scheme"] = "thermal"
    for body in content["bodies"]:
        del body["temperature_history"]
    content["interfaces"][0]["heat"] = {"law": "none"}
    content["materials"]["metal"] |= {"density": 1e3, "heat_capacity": 1e3, "conductivity": 1.0}
    del content["output"]
    case = read_case(content, Path("case.toml"))
    with pytest.raises(CaseError, match="opening_gap"):
        read_case({**content, "foundry": {"opening_gap": 0}}, Path("case.toml"))
    assert case.foundry.opening_gap == 1e-6
    mesh = build_mesh(case.geometry, ["casting", "mould"], MPI.COMM_SELF)
    assert first_openings_of(case, mesh, casting_pairs(mesh)).described() == {}
