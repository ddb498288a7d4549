"""Still pictures: what they show, where the ring is, and which field stands in."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import pyvista

from castx.report.display import display
from castx.report.page.shots import (
    RING,
    bar,
    drawable,
    finding_limits,
    finding_shot,
    moved_place,
    ringed,
    scales_of,
    stills,
    topic_of,
    trimmed,
    view_and_factor,
)
from castx.report.pictures import Scale, View
from castx.report.summary.finding import Finding, Shown
from castx.results.files.run_tables import Columns

pytestmark = pytest.mark.serial


def grids(time):
    """Return a casting in a mould with some of the fields of the report."""
    found = {}
    for left, name in enumerate(("casting", "mould")):
        image = pyvista.ImageData(dimensions=(4, 4, 1), origin=(3.0 * left, 0.0, 0.0))
        found[name] = image.cast_to_unstructured_grid()
        x = found[name].points[:, 0]
        found[name]["temperature"] = 600.0 - 50.0 * time * x
        found[name]["displacement"] = np.tile([1e-3, 0.0, 0.0], (found[name].n_points, 1))
    found["casting"]["von_mises"] = 1e8 * found["casting"].points[:, 0]
    return found


def results():
    times = [0.0, 1.0, 2.0]
    history = {"time": np.array(times), "casting.solid_fraction": np.array([0.0, 0.6, 1.0])}
    return SimpleNamespace(
        grids=lambda time=2.0: grids(time), times=times, model="plane-strain",
        freezing=["casting"], history=Columns(history), record={"interfaces": {}},
        nearest=lambda time, body=None: 2.0 if time is None else time,
    )  # fmt: skip


def centre_of_ring(image):
    rows, columns = np.nonzero((np.abs(image.astype(int) - RING) < 4).all(axis=2))
    return rows.mean(), columns.mean()


def test_the_ring_is_at_the_place():
    image = np.full((200, 400, 3), 255, dtype=np.uint8)
    flat = View("plane-strain", np.array([0.0, 0, 0]), np.array([4.0, 2, 0]), None, None)
    row, column = centre_of_ring(ringed(image, flat, np.array([1.0, 1.5, 0.0])))
    assert row == pytest.approx(50, abs=1) and column == pytest.approx(100, abs=1)


def test_the_ring_is_where_the_camera_sees_the_place_in_space():
    cube = pyvista.ImageData(dimensions=(2, 2, 2)).cast_to_unstructured_grid()
    view = View("3d", np.zeros(3), np.ones(3), None, np.array([-0.45, -1.0, 0.55]))
    with display():
        plotter = pyvista.Plotter(off_screen=True, window_size=list(view.window()))
        plotter.background_color = "white"
        corner = np.array([1.0, 0.0, 1.0])
        plotter.add_mesh(pyvista.Sphere(0.02, corner), color="black", lighting=False)
        view.aim(plotter)
        image = np.asarray(plotter.screenshot(return_img=True))
        plotter.close()
    rows, columns = np.nonzero(image.max(axis=2) < 50)
    found = centre_of_ring(ringed(image, view, corner))
    assert found == pytest.approx((rows.mean(), columns.mean()), abs=1.5)
    assert cube.n_points == 8


def test_the_place_moves_with_its_node():
    found = moved_place(grids(0.0), ["casting"], [1.0, 1.0], 100.0)
    assert found == pytest.approx([1.1, 1.0, 0.0])
    assert moved_place(grids(0.0), ["casting"], [1.0, 1.0], 0.0) == pytest.approx([1.0, 1.0, 0.0])


def test_another_field_stands_in_for_one_that_was_not_written():
    run = results()
    assert drawable(run, Shown("deviation", ("casting",))).field == "distance"
    assert drawable(run, Shown("largest_principal_stress", ("casting",))).field == "von_mises"
    assert drawable(run, Shown("stress_error", ("casting",))).field == "von_mises"
    assert drawable(run, Shown("solid_fraction", ("casting",))).field == "temperature"
    assert drawable(run, Shown("temperature", ("gone",))) is None


@pytest.mark.parametrize("field", ["wall_suction", "gap", "life", "heat_flux_error"])
def test_no_field_stands_in_for_one_of_which_it_does_not_tell(field):
    assert drawable(results(), Shown(field, ("casting",))) is None
    assert drawable(results(), Shown("stress_error", ("mould",))) is None


def blocks(time=2.0):
    """Return a casting of 1 x 2 x 1 m between the halves of a mould of 3 x 4 x 3 m."""
    found = {}
    for name, low, sides in (
        ("casting", (1, 1, 1), (1, 2, 1)),
        ("low", (0, 0, 0), (3, 4, 1)),
        ("high", (0, 0, 2), (3, 4, 1)),
    ):
        image = pyvista.ImageData(
            dimensions=(4, 9, 4), origin=low, spacing=np.array(sides) / (3, 8, 3)
        )
        found[name] = image.cast_to_unstructured_grid()
        found[name]["von_mises"] = 1e8 * found[name].points[:, 0]
        found[name]["displacement"] = np.zeros((found[name].n_points, 3))
    return found


@pytest.mark.parametrize(
    "body, y, cut",
    [
        ("casting", 2.5, 2.496), ("casting", 1.0, 1.3), ("casting", None, 2.0), ("low", 2.0, 1.996),
        ("low", 0.0, 1.3), ("low", 4.0, 2.7), ("high", None, 2.0),
    ],
)  # fmt: skip
def test_a_cut_goes_through_the_place_and_through_the_casting(body, y, cut):
    run = results()
    run.model, run.grids = "3d", blocks
    place = None if y is None else [1.0, y, 1.0]
    view, _ = view_and_factor(run, blocks(), Shown("von_mises", (body,)), place)
    assert view.cut == pytest.approx(cut)


@pytest.mark.parametrize("y, ringed", [(2.5, True), (2.9, True), (1.31, True), (1.0, False)])
def test_a_place_that_is_cut_away_has_no_ring(monkeypatch, y, ringed):
    run = results()
    run.model, run.grids = "3d", blocks
    points = []
    monkeypatch.setattr(
        "castx.report.page.shots.ringed", lambda image, view, point: points.append(point) or image
    )
    finding = Finding(
        "Stress at the end", "casting", 3e8, "MPa", "", place=[1.0, y, 1.0],
        shown=Shown("von_mises", ("casting",), 2.0),
    )  # fmt: skip
    with display():
        assert finding_shot(run, finding) is not None
    assert [point.tolist() for point in points] == [[1.0, y, 1.0]] * ringed


@pytest.mark.parametrize("y, cut", [(2.5, 2.496), (1.0, 1.3)])
def test_a_cut_moves_with_the_place_in_a_picture_with_displacements(y, cut):
    state = blocks()
    for grid in state.values():
        grid["displacement"][:, 1] = 1e-3
    run = results()
    run.model, run.grids = "3d", lambda time=2.0: state
    shown = Shown("von_mises", ("casting",), moved=True)
    view, factor = view_and_factor(run, state, shown, [1.0, y, 1.0])
    assert factor > 10.0
    assert view.cut == pytest.approx(cut + 1e-3 * factor)


@pytest.mark.parametrize("y, side", [(1.0, -1.0), (3.0, 1.0)])
def test_a_part_that_has_left_its_mould_is_seen_from_the_side_of_the_place(y, side):
    grid = blocks()["casting"]
    grid["displacement"] = -1e-3 * (grid.points - 1.0)
    run = results()
    run.model, run.grids = "3d", lambda time=2.0: {"casting": grid}
    shown = Shown("von_mises", ("casting",), moved=True)
    view, _ = view_and_factor(run, {"casting": grid}, shown, [1.5, y, 1.5])
    assert view.cut is None and np.sign(view.direction[1]) == side


def test_a_body_that_a_cut_takes_away_is_not_drawn():
    def beside(time=2.0):
        image = pyvista.ImageData(dimensions=(2, 2, 2), origin=(0, 0, 0), spacing=(1, 0.5, 1))
        core = image.cast_to_unstructured_grid()
        core["von_mises"] = 1e8 * core.points[:, 0]
        return blocks() | {"core": core}

    run = results()
    run.model, run.grids = "3d", beside
    finding = Finding(
        "Stress at the end", "low", 3e8, "MPa", "", place=[1.0, 2.0, 1.0],
        shown=Shown("von_mises", ("low",), 2.0),
    )  # fmt: skip
    with display():
        shot = finding_shot(run, finding)
    assert shot is not None and shot.bars[0].high == "300"


@pytest.mark.parametrize(
    "place, sides",
    [([1.5, 2.0, 2.0], (1, 1, 1)), ([1.5, 2.0, 1.0], (1, 1, -1)), ([1.0, 2.0, 1.5], (-1, 1, 1)),
     ([1.5, 1.0, 1.5], (1, -1, 1)), (None, (1, 1, 1))],
)  # fmt: skip
def test_one_looks_from_outside_at_the_face_of_the_place(place, sides):
    run = results()
    run.model, run.grids = "3d", lambda time=2.0: {"casting": blocks()["casting"]}
    shown = Shown("von_mises", ("casting",), outside=True)
    view, _ = view_and_factor(run, run.grids(), shown, place)
    assert tuple(np.sign(view.direction)) == sides and view.cut is None


def test_an_end_of_colours_is_zero_where_it_is_next_to_none():
    topic = topic_of("von_mises")
    ends = [(bar(topic, Scale((low, 2e7), "viridis", ("part",)))) for low in (19.0, -19.0, 4e4)]
    assert [(end.low, end.high) for end in ends] == [("0", "20"), ("0", "20"), ("0.04", "20")]


def test_distortion_is_drawn_by_displacements_where_no_deviation_was_written():
    shown = Shown("deviation", ("casting",), 2.0, moved=True)
    finding = Finding("Distortion", "casting", 4e-3, "mm", "", shown=shown)

    def stretched(time=2.0):
        found = grids(time)
        for grid in found.values():
            grid["displacement"][:, 0] *= grid.points[:, 0]
        return found

    run = results()
    run.grids = stretched
    assert finding_limits(run, finding) == {"distance viridis": pytest.approx((0.0, 3e-3))}
    with display():
        shot = finding_shot(run, finding)
    assert shot.title.startswith("Displacement, displacements ")
    assert [bar.label for bar in shot.bars] == ["Displacement [mm], casting"]
    assert shot.bars[0].high == "3"


def test_castings_have_colours_of_their_own():
    own, beside = scales_of(grids(1.0), topic_of("temperature"), ("casting",))
    assert own.limits == pytest.approx((450.0, 600.0)) and own.bodies == ("casting",)
    assert beside.limits == pytest.approx((300.0, 450.0)) and beside.colours != own.colours


def test_a_finding_has_its_picture_with_bars():
    finding = Finding(
        "Residual stress", "casting", 3e8, "MPa", "", place=[1.0, 1.0],
        shown=Shown("von_mises", ("casting",), 2.0, moved=True),
    )  # fmt: skip
    with display():
        shot = finding_shot(results(), finding)
        row = stills(results())
    assert shot.source.startswith("data:image/png;base64,") and "displacements" in shot.title
    (bar,) = shot.bars
    assert (bar.low, bar.high) == ("0", "300") and "MPa" in bar.label
    assert [still.title for still in row] == [
        "t = 1 s: 25 % solid, 50 % solid", "t = 2 s: 75 % solid, 95 % solid, all solid, end"
    ]  # fmt: skip
    quiet = Finding("Force to draw", "core", 1.0, "kN", "")
    assert finding_shot(results(), quiet) is None


def test_the_white_rim_is_cut_off():
    image = np.full((100, 80, 3), 255, dtype=np.uint8)
    image[20:30, 30:40] = 0
    assert trimmed(image).shape == (22, 22, 3)
    white = np.full((5, 5, 3), 255, dtype=np.uint8)
    assert trimmed(white) is white
