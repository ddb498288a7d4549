"""The ends of stages and cycles, and a record that goes on."""

from __future__ import annotations

import json
from dataclasses import replace

from mpi4py import MPI

import numpy as np
import pytest

from castx.foundry.pools.feeding_surfaces import FeedingSurfaces
from castx.foundry.stress.stage_ends import StageEnds
from castx.results.states.snapshot import ProcessState
from tests.castx.fakes import FakeSnapshot, cylinder_mesh


@pytest.fixture(scope="module")
def mesh():
    return cylinder_mesh(MPI.COMM_WORLD, size=6e-3)


def state(mesh, time, cycle, stage):
    """Return a state whose von Mises stress is the time in MPa."""
    formulas = {
        "stress": lambda x: np.tile([1e6 * time, 0, 0, 0, 0, 0], (len(x), 1)),
        "displacement": lambda x: -1e-3 * time * x,
        "temperature": lambda x: 500.0 - 10.0 * time - x[:, 0],
    }
    process = ProcessState(stage=stage, cycle=cycle)
    hindered = ("casting",) if stage == 0 else ()
    return FakeSnapshot(time, 0, mesh, formulas=formulas, process=process, hindered=hindered)


COURSE = [(0, 1, 0), (1, 1, 0), (2, 1, 1), (3, 1, 1), (4, 2, 0), (5, 2, 1)]


def follow(ends, mesh, course):
    for time, cycle, stage in course:
        ends.update(state(mesh, float(time), cycle, stage))
    return ends


def test_the_last_state_of_each_stage_in_the_last_cycle_is_described(mesh):
    found = follow(StageEnds(mesh, ["casting"]), mesh, COURSE).described()
    assert [(end["time"], end["cycle"], end["stage"]) for end in found] == [(4, 2, 0), (5, 2, 1)]
    for end in found:
        assert list(end["bodies"]) == ["casting"]
        stress = end["bodies"]["casting"]["stress"]
        assert stress["von_mises"]["value"] == pytest.approx(1e6 * end["time"], rel=1e-12)
        assert stress["mean_von_mises"] == pytest.approx(1e6 * end["time"], rel=1e-12)
        assert stress["high_von_mises"] == pytest.approx(1e6 * end["time"], rel=1e-9)
        hottest = end["bodies"]["casting"]["hottest"]
        assert hottest == pytest.approx(500.0 - 10.0 * end["time"], abs=1e-9)
        assert end["bodies"]["casting"]["hindered"] == (end["stage"] == 0)
        shrunk = end["bodies"]["casting"]["distortion"]["allowance"]
        assert shrunk == pytest.approx([1e-3 * end["time"]] * 2, rel=1e-9)


def test_surfaces_that_feed_have_no_deviation(mesh):
    ends = StageEnds(mesh, ["casting"], fed={"casting": FeedingSurfaces(("top",))})
    follow(ends, mesh, COURSE[:2])
    height = mesh.bodies["casting"].points[:, 1]
    inside = mesh.bodies["casting"].points[:, 0] < 0.015
    top = inside & (height > height.max() - 1e-9)
    assert np.isnan(ends.deviation("casting")[top]).all()
    whole = follow(StageEnds(mesh, ["casting"]), mesh, COURSE[:2])
    assert np.isfinite(whole.deviation("casting")[top]).all()


@pytest.mark.parametrize("stop", range(1, len(COURSE)))
def test_a_run_that_goes_on_describes_the_same_ends(mesh, stop):
    whole = follow(StageEnds(mesh, ["casting"]), mesh, COURSE).described()
    first = follow(StageEnds(mesh, ["casting"]), mesh, COURSE[:stop]).described()
    second = StageEnds(mesh, ["casting"])
    second.resume(json.loads(json.dumps(first)))
    assert second.described() == first
    assert follow(second, mesh, COURSE[stop:]).described() == whole


@pytest.mark.ranks
def test_a_body_between_planes_of_symmetry_has_stress_alone(mesh):
    body = mesh.bodies["casting"]
    surfaces = {f"symmetry-{name}": tag for name, tag in body.surfaces.items()}
    nodes = {f"symmetry-{name}": found for name, found in body.nodes_on.items()}
    closed = replace(body, surfaces=surfaces, nodes_on=nodes)
    ends = StageEnds(replace(mesh, bodies={"casting": closed}), ["casting"])
    (end,) = follow(ends, mesh, COURSE[:1]).described()
    assert list(end["bodies"]["casting"]) == ["stress", "hindered", "hottest"]
    assert ends.deviation("casting") is None


@pytest.mark.ranks
def test_the_deviation_is_that_of_the_last_state(mesh):
    ends = StageEnds(mesh, ["casting"])
    assert ends.deviation("casting") is None
    follow(ends, mesh, COURSE[:3])
    r, z = mesh.bodies["casting"].points.T
    side = (r > 0.02 - 1e-9) & (z > 1e-9) & (z < 0.04 - 1e-9)
    np.testing.assert_allclose(ends.deviation("casting")[side], -2e-3 * 0.02, rtol=1e-9)
    assert ends.deviation("mould") is None
