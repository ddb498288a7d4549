"""A casting with two heavy sections and a neck: the lower one is cut off when the neck freezes.

What is followed from step to step is compared with the times at which the limit passes every node,
which another part of the program finds: the last connection breaks at the largest value, over all
ways to the surface that feeds, of the earliest passing on the way.
"""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import gmsh
import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import minimum_spanning_tree

from castx.command.run import run
from castx.domain.source import gmsh_session
from castx.results.reading import Results

LOWER, NECK, UPPER = (0.02, 0.04), (0.007, 0.02), (0.024, 0.04)
"""Radius and height of each part [m]."""
SIZE, LIMIT = 4e-3, 0.6
STEP, BREAK, END = 1.0, 14.0, 24.0
CASE = f"""
[geometry]
file = "part.msh"
model = "axisymmetric"
[[bodies]]
name = "casting"
material = "metal"
temperature = 640
[[boundaries]]
on = "casting/outside"
heat = {{ type = "convection", coefficient = 1200, ambient = 100 }}
[materials.metal]
extends = "AlSi7Mg"
solidification_shrinkage = 0.06
[time]
end = {END}
fixed_step = {STEP}
first_step = {STEP}
largest_step = {STEP}
[coupling]
scheme = "thermal"
[output]
fields = ["passing_times", "pool", "solid_fraction"]
[foundry]
passing_times = [{LIMIT}]
pool_limit = {LIMIT}
feeders = ["casting/top"]
"""


def draw():
    """Draw the meridian from the base to the top."""
    model = gmsh.model.geo
    levels = np.cumsum([0.0, LOWER[1], NECK[1], UPPER[1]])
    profile = [(0.0, 0.0)]
    for (radius, _), low, high in zip((LOWER, NECK, UPPER), levels[:-1], levels[1:], strict=True):
        profile += [(radius, low), (radius, high)]
    profile.append((0.0, levels[-1]))
    points = [model.addPoint(r, z, 0.0, SIZE) for r, z in profile]
    lines = [model.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    face = model.addPlaneSurface([model.addCurveLoop(lines)])
    model.synchronize()
    gmsh.model.addPhysicalGroup(2, [face], name="casting")
    gmsh.model.addPhysicalGroup(1, lines[:-2], name="outside")
    gmsh.model.addPhysicalGroup(1, lines[-2:-1], name="top")
    gmsh.model.mesh.generate(2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    comm = MPI.COMM_WORLD
    place = Path(comm.bcast(tmp_path_factory.mktemp("sections")))
    if comm.rank == 0:
        with gmsh_session():
            draw()
            gmsh.write(str(place / "part.msh"))
        (place / "case.toml").write_text(CASE)
    comm.Barrier()
    return place


@pytest.fixture(scope="module")
def alone(folder):
    """The run on one rank, without a break."""
    if MPI.COMM_WORLD.rank == 0:
        run(folder / "case.toml", output=folder / "alone", comm=MPI.COMM_SELF)
    MPI.COMM_WORLD.Barrier()
    return Results(folder / "alone")


def passing(results):
    """Return points, times and cells; liquid nodes pass at the end at the earliest."""
    found = results.field(f"passing_time_{LIMIT!r}", "casting")
    return found.points, np.where(np.isnan(found.values), END, found.values), found.cells


def broken(points, times, cells, low, top):
    """Return when the last way from a node to others breaks, by the tree of the latest edges."""
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    lasts = times[edges].min(axis=1)
    shape = (len(points), len(points))
    # Weights of both directions add up, those of an edge of two cells as well.
    edges, first = np.unique(np.sort(edges, axis=1), axis=0, return_index=True)
    graph = coo_matrix((1e3 - lasts[first], edges.T), shape=shape)
    tree = minimum_spanning_tree(graph).tocoo()
    best = np.full(len(points), -np.inf)
    best[low] = times[low]
    for _ in range(len(points)):
        before = best.copy()
        for a, b in ((tree.row, tree.col), (tree.col, tree.row)):
            np.maximum.at(best, a, np.minimum(best[b], 1e3 - tree.data))
        if np.array_equal(before, best):
            break
    return best[top].max()


def test_the_lower_section_is_cut_off_when_the_neck_freezes(alone):
    points, times, cells = passing(alone)
    spots = alone.record["hot_spots"]
    worst = spots[0]
    lower = points[:, 1] < LOWER[1]
    last = np.flatnonzero(lower)[np.argmax(times[lower])]
    assert worst["parent"] == 1 and worst["body"] == "casting"
    assert worst["place"] == pytest.approx(points[last], abs=SIZE)
    assert worst["ended"] == pytest.approx(times[last], abs=1.5 * STEP)
    top = np.flatnonzero(points[:, 1] > points[:, 1].max() - 1e-6)
    cut_off = broken(points, times, cells, last, top)
    assert worst["isolated"] == pytest.approx(cut_off, abs=1.5 * STEP)
    assert worst["isolated"] < worst["ended"] - 5 * STEP
    volume = np.pi * LOWER[0] ** 2 * LOWER[1]
    assert 0.02 * volume < worst["volume"] < 0.5 * volume
    assert worst["deficit"] == pytest.approx(0.06 * worst["volume"], rel=1e-12)
    # The upper section feeds itself through its top for longer, and little of it is cut off.
    assert all(spot["deficit"] < 0.3 * worst["deficit"] for spot in spots[1:])


@pytest.mark.ranks
def test_the_same_on_any_number_of_ranks_and_after_a_break(comm, folder, alone):
    """The part breaks between isolation and end of the lower section."""
    case, output = folder / "case.toml", folder / "together"
    run(case, [f"time.end={BREAK}"], output=output, comm=comm)
    (before,) = Results(output).record["hot_spots"]
    assert before["isolated"] < BREAK and before["ended"] is None
    run(case, output=output, comm=comm, restart=True)
    whole, parts = (Results(folder / name).record["hot_spots"] for name in ("alone", "together"))
    assert len(whole) == len(parts) >= 1
    for one, other in zip(whole, parts, strict=True):
        for name, value in one.items():
            if name == "body":
                assert other[name] == value
            else:
                assert other[name] == pytest.approx(value, rel=1e-5), name
    table = (output / "hot_spots.csv").read_text().splitlines()
    assert len(table) == 1 + len(parts)
    assert table[1].startswith(f"1,casting,{parts[0]['pool']},1,")
