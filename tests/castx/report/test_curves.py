"""Diagrams and rows of pictures, looked at by their pixels and by what is drawn on their axes."""

from __future__ import annotations

from io import BytesIO

import matplotlib.image
import numpy as np
import pytest
from matplotlib.figure import Figure

from castx.arrays import FloatArray
from castx.report.curves import COLOURS, Panel, curves, draw, row, trimmed

pytestmark = pytest.mark.serial

TIME: FloatArray = np.linspace(0.0, 1.0, 50, dtype=np.float64)


def pixels(png: bytes) -> np.ndarray:
    """Return the colours of a picture (height, width, 3) from 0 to 1."""
    return matplotlib.image.imread(BytesIO(png))[..., :3]


def drawn(panel: Panel):
    """Return the axes on which a diagram was drawn."""
    axis = Figure().subplots()
    draw(axis, TIME, panel)
    return axis


def test_curves_are_drawn_in_their_colours():
    panel = Panel("T [°C]", {"a": 100.0 * TIME, "b": 50.0 + 0.0 * TIME}, {"melting point": 80.0})
    found = pixels(curves(TIME, [panel, panel]))
    for colour in COLOURS[:2]:
        wanted = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        assert (np.abs(found - wanted).max(axis=2) < 0.02).sum() > 500


def test_each_diagram_adds_the_same_height():
    panel = Panel("T [°C]", {"a": TIME})
    one, two, three = (pixels(curves(TIME, [panel] * count)).shape[0] for count in (1, 2, 3))
    assert two - one == three - two > 300


def test_round_off_is_drawn_as_zero():
    low, high = drawn(Panel("gap [µm]", {"a": 1e-12 * TIME}, least=1.0)).get_ylim()
    assert low == -0.05 and high == 1.0
    low, high = drawn(Panel("gap [µm]", {"a": 5.0 * TIME}, least=1.0)).get_ylim()
    assert high > 5.0


def test_a_level_is_a_line_with_its_name():
    axis = drawn(Panel("T [°C]", {"a": 100.0 * TIME}, {"solidus": 80.0}))
    assert [text.get_text() for text in axis.texts] == ["solidus"]
    assert axis.lines[-1].get_ydata()[0] == 80.0


def test_a_single_curve_named_in_its_label_needs_no_legend():
    assert drawn(Panel("step [s]", {"step": TIME})).get_legend() is None
    assert drawn(Panel("step [s]", {"size": TIME})).get_legend() is not None


def test_a_logarithmic_diagram_leaves_zeros_out():
    axis = drawn(Panel("error", {"error": np.where(TIME > 0.5, 1e-8, 0.0)}, logarithmic=True))
    assert axis.get_yscale() == "log" and axis.get_ylim()[0] > 0.0


def test_a_row_shows_its_pictures_and_a_bar_of_their_colours():
    red = np.full((60, 60, 3), 255, dtype=np.uint8)
    red[10:50, 10:50] = (200, 0, 0)
    one, two = (row([red] * count, ["t"] * count, "T", (0.0, 1.0), "gray") for count in (1, 2))
    counts = [(np.abs(pixels(png) - [200 / 255, 0, 0]).max(axis=2) < 0.02).sum()
              for png in (one, two)]  # fmt: skip
    assert counts[1] > 1.5 * counts[0] > 0
    grey = np.ptp(pixels(one), axis=2) < 0.01
    assert len(np.unique(np.round(pixels(one)[grey], 2))) > 50  # the colour bar, black to white


def test_the_white_rim_that_all_pictures_have_is_cut_off():
    first, second = np.full((2, 100, 80, 3), 255, dtype=np.uint8)
    first[20:30, 30:40], second[60:70, 35:45] = 0, 0
    found = trimmed([first, second])
    assert [image.shape for image in found] == [(66, 31, 3)] * 2
    white = np.full((5, 5, 3), 255, dtype=np.uint8)
    assert trimmed([white])[0] is white


def test_what_was_measured_stands_on_the_colour_of_its_curve_within_the_run():
    late = np.linspace(-1.0, 5.0, 601)
    axis = drawn(Panel("T [°C]", {"a": TIME, "b": 2 * TIME}, points={"b": (late, 2 * late)}))
    lines = axis.get_lines()
    assert [line.get_label() for line in lines] == ["a", "b", "b, measured"]
    assert lines[2].get_color() == lines[1].get_color() != lines[0].get_color()
    assert 40 < len(lines[2].get_xdata()) <= 80
    assert axis.get_xlim() == (TIME[0], TIME[-1])
