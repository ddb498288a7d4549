"""Pictures hold what they should: looked at by the colours of their pixels, without a display."""

import os

import numpy as np
import pytest
import pyvista

from castx.foundry.front.solidification import Solidification
from castx.report.display import display
from castx.report.pictures import (
    Scale,
    View,
    chosen_times,
    exaggeration,
    limits_of,
    picture,
)
from castx.results.fields import Fields
from castx.results.files.collection import FieldSeries
from castx.results.files.disk import Disk
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh

pytestmark = pytest.mark.serial

FORMULAS = {
    "temperature": lambda x: 300.0 + 1e4 * x[:, 0],
    "solid_fraction": lambda x: np.clip(x[:, -1] / 0.04, 0.0, 1.0),
    "displacement": lambda x: -1e-3 * x,
}


@pytest.fixture
def series(comm, tmp_path, request):
    model, _, cells = request.param.partition(" of ")
    mesh = cylinder_mesh(comm, model, 5e-3, cells or "simplices")
    (tmp_path / "fields").mkdir()
    names = ("temperature", "solid_fraction", "displacement", "niyama")
    writer = Fields(tmp_path / "fields", names, None, mesh, Solidification(mesh, {}), Disk(comm))
    writer.update(FakeSnapshot(0.0, 0, mesh, casting_pairs(mesh), FORMULAS))
    return FieldSeries(tmp_path)


def share(image, colour):
    """Return the share of the pixels near a colour."""
    return float((np.abs(image.astype(int) - colour).max(axis=2) < 12).mean())


@pytest.mark.parametrize(
    "series", ["axisymmetric", "axisymmetric of quadrilaterals"], indirect=True
)
def test_an_axisymmetric_body_is_shown_with_its_mirror_image(series, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    grids = series.read(0.0)
    view = View.of("axisymmetric", grids.values())
    with display():
        image = picture(
            view, grids, "temperature", (300.0, 700.0), colours="gray", coloured=list(grids)
        )
    assert "DISPLAY" not in os.environ
    middle = image[image.shape[0] // 2, :, 0].astype(int)
    np.testing.assert_allclose(middle, middle[::-1], atol=3)
    drawn = np.flatnonzero(middle < 250)
    centre, quarter = middle[len(middle) // 2], middle[drawn[0] + len(drawn) // 4]
    assert centre < 20 and quarter == pytest.approx(0.375 * 255, abs=6)
    assert len(drawn) / len(middle) == pytest.approx(60.0 / (60.0 + 2 * 0.04 * 50.0), abs=0.03)


@pytest.mark.parametrize("series", ["3d", "3d of quadrilaterals"], indirect=True)
def test_a_quarter_is_seen_from_its_planes_of_symmetry(series):
    grids = series.read(0.0)
    view = View.of("3d", grids.values())
    assert view.direction is not None and (view.direction[:2] < 0.0).all()
    assert view.cut is None
    outside = View.of("3d", grids.values(), outside=True)
    assert (outside.direction[:2] > 0.0).all()
    with display():
        blue = picture(
            view, grids, "temperature", (0.0, 1.0), colours="Blues", coloured=["casting"],
            front=True, exaggeration=10.0,
        )  # fmt: skip
    assert 0.1 < share(blue, (201, 204, 209)) + share(blue, (190, 193, 198)) < 0.9
    assert share(blue, (255, 255, 255)) < 0.7


@pytest.mark.parametrize("series", ["3d"], indirect=True)
def test_limits_leave_out_what_does_not_exist(series):
    states = [series.read(0.0)]
    assert limits_of(states, "niyama", ["casting"]) is None
    assert limits_of(states, "von_mises", ["casting"]) is None
    assert limits_of(states, "temperature", ["casting"]) == pytest.approx((300.0, 500.0))
    low, high = limits_of(states, "temperature", ["casting", "mould"], 0.5)
    assert low == 300.0 and 400.0 < high < 600.0


@pytest.mark.parametrize("series", ["3d"], indirect=True)
def test_the_exaggeration_is_a_round_factor(series):
    grids = series.read(0.0)
    view = View.of("3d", grids.values())
    assert exaggeration(view, grids) == 50.0
    for grid in grids.values():
        grid["displacement"] *= 0.0
    assert exaggeration(view, grids) == 0.0


def test_times_are_those_after_what_happens_and_the_last_one():
    times = [float(t) for t in range(0, 91, 5)]
    moments = {11.0: "25 % solid", 12.0: "first air gap", 33.0: "all solid"}
    chosen = {15.0: "25 % solid, first air gap", 35.0: "all solid", 90.0: ""}
    assert chosen_times(times, moments) == chosen
    assert chosen_times([0.0, 3.0], {1.0: "50 % solid"}) == {3.0: "50 % solid"}
    assert chosen_times([0.0], {}) == {0.0: ""}


SHIFT = np.array([0.3, -0.7, 0.05])


def block(low, high, value):
    """Return a box of one temperature at a place that is not the origin."""
    image = pyvista.ImageData(dimensions=(9, 9, 9)).cast_to_unstructured_grid()
    low, high = np.array(low), np.array(high)
    image.points = SHIFT + low + image.points / 8.0 * (high - low)
    image["temperature"] = np.full(image.n_points, value)
    return image


def test_a_part_away_from_the_origin_is_cut_through_its_casting():
    casting = block([-0.02] * 3, [0.02, 0.02, 0.02], 100.0)
    mould = block([-0.05] * 3, [0.05, 0.09, 0.05], 0.0)
    away = np.abs(mould.cell_centers().points - SHIFT).max(axis=1)
    mould = mould.extract_cells(np.flatnonzero(away > 0.02))
    grids = {"casting": casting, "mould": mould}
    for castings in ([casting], []):  # the smallest, if nobody says which
        view = View.of("3d", grids.values(), castings=castings)
        assert view.cut == pytest.approx(SHIFT[1], abs=1e-6)
    with display():
        pixels = picture(
            view, grids, "temperature", (0.0, 100.0), colours="Reds", coloured=["casting"],
            beside=Scale((0.0, 1.0), "Blues", ("mould",)),
        )  # fmt: skip
    red, green, blue = (pixels[..., band].astype(int) for band in range(3))
    assert (red - blue > 60).mean() > 0.02  # the casting shows inside its mould
    assert ((red > 200) & (blue - red > 3) & (green > 200)).mean() > 0.2  # with its own colours


def test_a_casting_at_a_side_is_seen_from_there():
    casting, mould = block([0] * 3, [0.02] * 3, 1.0), block([0, 0, -0.03], [0.05] * 3, 0.0)
    view = View.of("3d", [casting, mould], castings=[casting])
    assert view.cut is None and (view.direction[:2] < 0.0).all()
    alone = View.of("3d", [mould])
    assert alone.cut == pytest.approx(SHIFT[1] + 0.025)


def test_a_smooth_picture_has_shades_between_its_colours():
    """A grey body on white, drawn without light: its edge, slanted, is in stairs or in shades."""
    grid = pyvista.ImageData(dimensions=(2, 2, 1), spacing=(0.02, 0.02, 0.0))
    grid = grid.rotate_z(20.0).cast_to_unstructured_grid()
    view = View.of("plane-strain", [grid])
    with display():
        counts = [
            len(np.unique(picture(view, {"casting": grid}, "none", (0.0, 1.0), colours="gray",
                                  coloured=(), smooth=smooth).reshape(-1, 3), axis=0))
            for smooth in (False, True)
        ]  # fmt: skip
    assert counts[0] < counts[1] / 2


@pytest.mark.parametrize(("field", "part"), [("temperature", 0.6), ("emptied", 1.0)])
def test_the_pipe_is_no_part_of_what_is_drawn_but_of_its_own_field(field, part):
    """The upper two fifths of a rectangle of 40 by 50 mm have flowed out."""
    grid = pyvista.ImageData(dimensions=(9, 11, 1), spacing=(0.005, 0.005, 1.0))
    body = grid.cast_to_unstructured_grid().triangulate()
    high = np.asarray(body.points)[:, 1]
    body.point_data["emptied"] = np.clip((high - 0.0275) / 0.005, 0.0, 1.0)
    body.point_data["temperature"] = 300.0 + high
    grids = {"casting": body}
    view = View.of("plane-strain", grids.values())
    with display():
        image = picture(view, grids, field, (1e3, 2e3), colours="gray", coloured=["casting"])
    dark = (image < 128).all(axis=2)[:, image.shape[1] // 2]
    metres = (view.high - view.low)[1] / len(dark)
    assert metres * dark.sum() == pytest.approx(part * 0.05, abs=3e-4)
