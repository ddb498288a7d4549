"""A field drawn for a figure: its colours are values, its extent is metres."""

from __future__ import annotations

import io
from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
import pyvista

from castx.errors import CaseError
from castx.report.drawing import draw

pytestmark = pytest.mark.serial


def plate(left: float, temperature: float) -> pyvista.UnstructuredGrid:
    """Return a plate of 10 by 20 mm that begins at x = left."""
    image = pyvista.ImageData(
        dimensions=(6, 11, 1), origin=(left, 0.0, 0.0), spacing=(2e-3, 2e-3, 1.0)
    )
    grid = image.cast_to_unstructured_grid()
    grid["temperature"] = np.full(grid.n_points, temperature)
    grid["displacement"] = np.tile([0.0, 1e-5, 0.0], (grid.n_points, 1))
    return grid


@pytest.fixture
def grids():
    return {"casting": plate(0.0, 100.0), "mould": plate(10e-3, 200.0)}


def at(drawing, x: float, y: float):
    """Return the colour at a point [m]."""
    left, right, lower, upper = drawing.extent
    height, width = drawing.pixels.shape[:2]
    row = round((upper - y) / (upper - lower) * (height - 1))
    column = round((x - left) / (right - left) * (width - 1))
    return drawing.pixels[row, column].astype(int)


def test_colours_are_values_at_places(grids):
    drawing = draw(grids, "temperature", "plane-strain", colours="gray")
    assert drawing.limits == (100.0, 200.0) and drawing.colours == "gray"
    assert at(drawing, 5e-3, 15e-3).max() < 10 and at(drawing, 15e-3, 5e-3).min() > 245
    assert at(drawing, 0.999 * drawing.extent[1], 0.0).min() == 255


@pytest.mark.parametrize("stretch", [(20.0, 1.0), (0.2, 10.0)])
def test_a_slender_part_is_shown_from_end_to_end(grids, stretch):
    for grid in grids.values():
        grid.points = grid.points * [*stretch, 1.0]
    drawing = draw(grids, "temperature", "plane-strain", colours="gray", factor=0.0)
    left, right, lower, upper = drawing.extent
    height, width = drawing.pixels.shape[:2]
    assert min(height, width) == 200 and max(height, width) == 900
    assert width / height == pytest.approx((right - left) / (upper - lower), rel=0.01)
    across, along = 20e-3 * stretch[0], 20e-3 * stretch[1]
    for share in (0.25, 0.75):  # away from the lines round the bodies
        assert at(drawing, 0.25 * across, share * along).max() < 10
        assert at(drawing, 0.75 * across, share * along).min() > 245
    assert at(drawing, 0.97 * right, 0.97 * upper).min() == 255


def test_limits_and_bodies_can_be_chosen(grids):
    drawing = draw(
        grids, "temperature", "plane-strain", limits=(0.0, 400.0), colours="gray",
        coloured=["mould"],
    )  # fmt: skip
    assert drawing.limits == (0.0, 400.0)
    assert at(drawing, 15e-3, 5e-3) == pytest.approx([127] * 3, rel=0.06)
    assert at(drawing, 5e-3, 5e-3) == pytest.approx([0xC9, 0xCC, 0xD1], rel=0.06)  # grey


def test_displacements_are_drawn_visibly(grids):
    drawing = draw(grids, "temperature", "plane-strain", colours="gray")
    moved = 1e-5 * drawing.exaggeration
    assert 0.02 < moved / 30e-3 < 0.07
    below, above = (drawing.extent[2] + share * 2e-3 for share in (0.0, 1.0))
    assert below < 0.0 < above < moved
    assert at(drawing, 5e-3, 0.4 * moved).min() == 255
    still = draw(grids, "temperature", "plane-strain", colours="gray", factor=0.0)
    assert still.exaggeration == 0.0 and at(still, 5e-3, 0.4 * moved).max() < 60


def test_an_axisymmetric_section_reaches_to_its_mirror_image(grids):
    left, right, _, _ = draw(grids, "temperature", "axisymmetric").extent
    assert left == pytest.approx(-right) and right > 20e-3


def test_a_picture_in_space_has_no_extent():
    cube = pyvista.ImageData(dimensions=(4, 4, 4)).cast_to_unstructured_grid()
    cube["temperature"] = np.arange(64.0)
    drawing = draw({"casting": cube}, "temperature", "3d")
    assert drawing.extent is None and np.ptp(drawing.pixels) > 100


def test_a_field_that_is_not_there_is_refused(grids):
    with pytest.raises(CaseError, match=r"no body has values of 'temprature'.*\"temperature\""):
        draw(grids, "temprature", "plane-strain")


def test_a_notebook_shows_it_with_axes_and_colour_bar(grids):
    drawing = draw(grids, "temperature", "plane-strain", colours="gray", coloured=["mould"])

    def shown(given):
        png = given._repr_png_()
        return png, matplotlib.image.imread(io.BytesIO(png))[..., :3]

    png, image = shown(drawing)
    part = image[:, round(0.75 * image.shape[1]) :]
    greys = np.unique(np.round(part[np.ptp(part, axis=2) < 1e-3][:, 0], 1))
    assert len(greys) >= 10, "the bar has all colours between black and white"
    assert shown(replace(drawing, limits=(0.0, 1.0)))[0] != png
    assert shown(replace(drawing, colours="viridis"))[0] != png
    flat = shown(replace(drawing, extent=None))[1]
    assert flat.shape == image.shape and not np.array_equal(flat, image)  # in space without axes
