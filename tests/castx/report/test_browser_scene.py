"""The scene holds meshes and fields of all moments as they were written."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import pyvista

from castx.report import browser_scene as module
from castx.report.browser_scene import reduced, scene, shown_range, shown_times
from castx.report.packing import LEVELS, unpacked
from castx.report.sunk_bodies import Pipes
from castx.report.topics import Topic, topics_of
from castx.results.files.run_tables import Columns

pytestmark = pytest.mark.serial


def body(time, left, cells=3):
    across = np.arange(3.0)
    corners = np.meshgrid(left + np.arange(cells + 1.0), across, across, indexing="ij")
    found = pyvista.StructuredGrid(*corners).cast_to_unstructured_grid()
    found["temperature"] = 600.0 - 10.0 * time + found.points[:, 0]
    found["displacement"] = 1e-3 * time * found.points
    found.cell_data["von_mises"] = 1e6 * time * np.arange(1.0, found.n_cells + 1.0)
    return found


def results(times=(0.0, 1.0, 2.0), removed_at=2.0):
    """Return a run whose mould is removed."""

    def grids(time=times[-1]):
        there = {"casting": body(time, 0.0), "mould": body(time, 3.0, 2)}
        return there if time < removed_at else {"casting": there["casting"]}

    history = {"time": np.array(times), "casting.solid_fraction": np.linspace(0, 1, len(times))}
    return SimpleNamespace(
        times=list(times), grids=grids, model="3d", freezing=["casting"],
        bodies=("casting", "mould"), history=Columns(history),
        record={"interfaces": {}, "process": [], "front": "f_s = 0.9"},
    )  # fmt: skip


def test_meshes_and_fields_come_back_with_their_moments():
    run = results()
    found = scene(run)
    assert found["times"] == [0.0, 1.0, 2.0] and found["moments"][1].startswith("25 % solid")
    assert found["bodies"]["mould"]["there"] == [True, True, False]
    mesh = run.grids(0.0)["casting"]
    stored = found["bodies"]["casting"]
    np.testing.assert_allclose(unpacked(stored["points"]), mesh.points)
    np.testing.assert_array_equal(unpacked(stored["cells"]).ravel(), mesh.cell_connectivity)
    assert stored["kind"] == "hexahedron"
    fields = {field["name"]: field for field in found["fields"]}
    assert list(fields) == ["temperature", "von_mises"]
    for name, field in fields.items():
        values = unpacked(field["bodies"]["casting"]["values"])
        written = np.array([run.grids(time)["casting"][name] for time in found["times"]])
        np.testing.assert_allclose(values, written, atol=0.51 * np.ptp(written) / LEVELS)
    assert fields["von_mises"]["bodies"]["casting"]["in_cells"]
    gone = unpacked(fields["temperature"]["bodies"]["mould"]["values"])
    assert np.isnan(gone[2]).all() and np.isfinite(gone[:2]).all()
    moved = unpacked(found["displacements"]["casting"])
    wanted = run.grids(2.0)["casting"]["displacement"].ravel()
    np.testing.assert_allclose(moved[2], wanted, atol=1e-6)


def test_a_run_in_space_is_first_shown_cut_through_its_castings():
    """Their mould would hide them."""
    run, around = results(), body(0.0, 0.0)
    around.points = 3.0 * around.points - 2.0
    run.grids = lambda time=2.0: {"casting": body(time, 0.0), "mould": around}
    assert scene(run)["cut"] == pytest.approx(1.0)


def test_bodies_have_colours_of_their_own():
    shown = {field["name"]: field["bodies"] for field in scene(results())["fields"]}["temperature"]
    assert shown["casting"]["colours"] != shown["mould"]["colours"]
    assert shown["casting"]["limits"] == pytest.approx((580.0, 603.0))
    assert shown["mould"]["limits"] == pytest.approx((593.0, 605.0))


def test_a_large_mesh_is_shown_by_its_surface(monkeypatch):
    monkeypatch.setattr(module, "LARGEST_MESH", 0)
    run = results()
    found = scene(run)
    assert found["hollow"] and found["bodies"]["casting"]["kind"] == "triangle"
    surface = reduced(run.grids(1.0), True, Pipes({}, {}))["casting"]
    values = unpacked(found["fields"][0]["bodies"]["casting"]["values"])
    np.testing.assert_allclose(values[1], surface["temperature"], atol=1e-3)


def test_moments_are_always_among_the_times_and_others_lie_between():
    times = [float(t) for t in range(101)]
    found = shown_times(times, [3.0, 50.0], 7)
    assert len(found) == 7 and {0.0, 3.0, 50.0, 100.0} <= set(found) and found == sorted(found)
    assert shown_times(times, [3.0, 50.0], 2) == [3.0, 50.0, 100.0]
    assert shown_times([0.0, 1.0], [1.0], 48) == [0.0, 1.0]


def test_fewer_moments_are_kept_of_large_meshes(monkeypatch):
    times = tuple(float(t) for t in range(11))
    run = results(times, removed_at=99.0)
    assert len(scene(run)["times"]) == 11
    monkeypatch.setattr(module, "LARGEST", 4000)
    assert len(scene(run)["times"]) < 11


def test_round_off_has_no_colours():
    topic = Topic("von_mises", "", "", "MPa", "viridis", 1e-6)
    assert shown_range(np.array([0.0, 0.5]), topic) is None
    assert shown_range(np.array([np.nan]), topic) is None
    assert shown_range(np.array([1e6, np.nan, 3e6]), topic) == (1e6, 3e6)
    assert shown_range(np.array([-1e-130, 3e6]), topic) == (0.0, 3e6)
    assert shown_range(np.array([-1.0, 3e6]), topic) == (-1.0, 3e6)


def test_colours_of_gaps_begin_with_closed_ones():
    (gap,) = topics_of(["gap"])
    assert shown_range(np.array([-2e-6, 1e-6, 5e-6]), gap) == (0.0, 5e-6)
    assert shown_range(np.array([1e-6, 5e-6]), gap) == (1e-6, 5e-6)
    assert shown_range(np.array([-2e-6, -1e-7]), gap) == (-2e-6, -1e-7)
