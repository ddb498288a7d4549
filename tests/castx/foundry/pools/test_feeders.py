"""The pipe of a run: history, record and field, on any ranks, after a break, by each input."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.fields.feeding import EMPTIED
from castx.case.reading.read import read_case
from castx.command.run import run
from castx.domain.mesh import build_mesh
from castx.errors import CaseError
from castx.foundry.pools.feeders import feeders_of
from castx.input.toml_text import parse_toml
from castx.results.reading import Results
from castx.results.states.snapshot import ProcessState
from tests.castx.fakes import FakeSnapshot, casting_pairs

SHRINKAGE, HEIGHT = 0.06, 0.04
PIPE = SHRINKAGE  # β/(1 + β) = s
CASE = f"""
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = 0.02
height = {HEIGHT}
wall = 0.004
size = 2.5e-3
[[bodies]]
name = "casting"
material = "metal"
temperature = 620
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 100
[[interfaces]]
bodies = ["casting", "mould"]
heat = {{ law = "constant", closed = 1500 }}
[[boundaries]]
on = "mould/outside"
heat = {{ type = "convection", coefficient = 3000, ambient = 20 }}
[loads]
gravity = [0, -9.81]
[materials.metal]
extends = "AlSi7Mg"
solidification_shrinkage = {SHRINKAGE}
[time]
end = 60
first_step = 1
largest_step = 2
fixed_step = 2
[coupling]
scheme = "thermal"
[output]
fields = ["solid_fraction", "emptied"]
[foundry]
mass_feeding_limit = 1.0
feeders = ["casting/top"]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    comm = MPI.COMM_WORLD
    place = Path(comm.bcast(tmp_path_factory.mktemp("feeders")))
    if comm.rank == 0:
        (place / "case.toml").write_text(CASE)
        run(place / "case.toml", output=place / "alone", comm=MPI.COMM_SELF)
    comm.Barrier()
    return place


@pytest.fixture(scope="module")
def alone(folder):
    return Results(folder / "alone")


@pytest.mark.ranks
def test_a_whole_run_leaves_the_pipe_of_its_metal(alone):
    volume = np.pi * 0.02**2 * HEIGHT
    assert alone.history["casting.solid_fraction"][-1] > 1.0 - 1e-6
    pipe = alone.history["casting.pipe_volume"]
    assert pipe[-1] == pytest.approx(PIPE * volume, rel=1e-8)
    level = alone.history["casting.feeder_level.top"]
    assert level[0] == HEIGHT and (np.diff(level) <= 0.0).all() and level[-1] < 0.9 * HEIGHT
    said = alone.record["feeding"]["casting"]
    assert said["pipe_volume"] == pipe[-1] and said["levels"] == {"top": level[-1]}
    assert said["unfed_volume"] == pytest.approx(0.0, abs=1e-9 * volume)


def test_the_field_shows_the_pipe_and_nothing_else(alone):
    found = alone.field(EMPTIED, "casting")
    high = found.points[:, 1] > HEIGHT - 1e-6
    assert found.values.min() >= 0.0 and 0.95 < found.values[high].max() <= 1.0
    assert found.values[found.points[:, 1] < 0.4 * HEIGHT].max() < 1e-3


@pytest.mark.ranks
def test_the_same_on_any_ranks_and_after_a_break(comm, folder, alone):
    case, output = folder / "case.toml", folder / "together"
    run(case, ["time.end=14"], output=output, comm=comm)
    run(case, output=output, comm=comm, restart=True)
    other = Results(output)
    for name in ("casting.pipe_volume", "casting.feeder_level.top"):
        np.testing.assert_allclose(other.history[name], alone.history[name], rtol=1e-6)
    one, same = (result.field(EMPTIED, "casting") for result in (alone, other))
    order, again = (np.lexsort(field.points.T.round(9)) for field in (one, same))
    np.testing.assert_allclose(same.values[again], one.values[order], atol=1e-5)


def case_with(**changes):
    content = parse_toml(CASE)
    for path, value in changes.items():
        part, _, key = path.partition("__")
        content[part] = {**content[part], key: value} if key else value
    return read_case(content, Path("case.toml"))


def pipe_of(case, comm):
    """Return volumes of the pipe and the level of metal that freezes alike to 0.8."""
    mesh = build_mesh(case.geometry, ["casting", "mould"], comm)
    feeders = feeders_of(case, mesh)
    for fraction in (0.0, 0.5, 0.8):
        formulas = {"solid_fraction": lambda x, f=fraction: np.full(len(x), f)}
        process = ProcessState()
        feeders.update(FakeSnapshot(0.0, 0, mesh, casting_pairs(mesh), formulas, process=process))
    return feeders.totals()


@pytest.mark.ranks
def test_each_input_changes_the_pipe(comm):
    usual = pipe_of(case_with(), comm)
    assert set(usual) == {"casting.pipe_volume", "casting.feeder_level.top"}
    lower = pipe_of(case_with(foundry__mass_feeding_limit=0.6), comm)
    assert lower["casting.pipe_volume"] < 0.9 * usual["casting.pipe_volume"]
    pools = case_with(foundry={"pool_limit": 0.6, "feeders": ["casting/top"]})
    assert pipe_of(pools, comm) == lower
    free = pipe_of(case_with(foundry={"mass_feeding_limit": 1.0}), comm)
    assert free["casting.feeder_level.free"] == usual["casting.feeder_level.top"]
    assert not pipe_of(case_with(foundry__feeders=[]), comm)["casting.pipe_volume"]
    upside = case_with(loads__gravity=[0, 9.81], foundry__feeders=["casting/base"])
    assert -HEIGHT < pipe_of(upside, comm)["casting.feeder_level.base"] < 0.0


def test_without_gravity_or_shrinkage_there_is_no_pipe(comm):
    bare = {"output__fields": ["temperature"]}
    still = case_with(**bare, loads__gravity=[0, 0])
    swelling = case_with(**bare, materials__metal={"extends": "AlSi7Mg",
                                                   "solidification_shrinkage": -0.01})  # fmt: skip
    assert pipe_of(still, comm) == pipe_of(swelling, comm) == {}


@pytest.mark.serial
def test_the_field_is_refused_without_gravity():
    with pytest.raises(CaseError, match=r"loads\.gravity.*what is up"):
        case_with(loads__gravity=[0, 0])
    with pytest.raises(CaseError, match=r"has no solidification_shrinkage"):
        bare = {"density": 2400, "heat_capacity": 1000, "conductivity": 100, "latent_heat": 4e5,
                "solidus": 560, "liquidus": 610}  # fmt: skip
        case_with(materials__metal=bare)


@pytest.mark.ranks
def test_new_metal_fills_the_body_again(comm):
    case = case_with()
    mesh = build_mesh(case.geometry, ["casting", "mould"], comm)
    feeders = feeders_of(case, mesh)

    def follow(fraction, *renewed):
        formulas = {"solid_fraction": lambda x: np.full(len(x), fraction)}
        process = ProcessState(renewed=frozenset(renewed))
        pairs = casting_pairs(mesh)
        feeders.update(FakeSnapshot(0.0, 0, mesh, pairs, formulas, process=process))
        return feeders.totals()["casting.pipe_volume"]

    follow(0.0)
    assert follow(0.8) > 0.0
    assert follow(0.0, "casting") == 0.0
    assert feeders.field("mould", EMPTIED) is None
