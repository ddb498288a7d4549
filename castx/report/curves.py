"""Curves over time and rows of pictures as PNG, drawn with matplotlib without a display."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from castx.arrays import FloatArray
from castx.report.pictures import Image

DOTS_PER_INCH = 150
MOST_POINTS = 60
"""Of a measured curve that are drawn, about."""
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#5b5b5b", "#8c6d31")
"""Distinguishable with any kind of colour vision (M. Okabe and K. Ito, 2008), greys added."""

STYLE = {
    "font.size": 10,
    "axes.edgecolor": "#8a8f98",
    "axes.labelcolor": "#30343a",
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.prop_cycle": cycler(linestyle=("-", "--")) * cycler(color=COLOURS),
    "grid.color": "#e3e5e8",
    "grid.linewidth": 0.8,
    "xtick.color": "#30343a",
    "ytick.color": "#30343a",
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "legend.fontsize": 9,
}


@dataclass(frozen=True)
class Panel:
    """One diagram.

    Args:
        label: of the ordinate, with its unit.
        lines: ordinates by the name of the curve.
        levels: thin horizontal lines, by name.
        logarithmic: whether the ordinate is.
        steps: whether each value is that of the whole step before.
        least: height that the ordinate has at least, so that round-off is drawn as zero.
        points: times [s] and ordinates of what was measured, by the name of its curve.
    """

    label: str
    lines: Mapping[str, FloatArray]
    levels: Mapping[str, float] = field(default_factory=dict)
    logarithmic: bool = False
    steps: bool = False
    least: float = 0.0
    points: Mapping[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)


def curves(time: FloatArray, panels: Sequence[Panel]) -> bytes:
    """Return diagrams over the same time [s], one below the other, as PNG.

    Args:
        time: (steps,) [s].
        panels: the diagrams, whose lines are (steps,).
    """
    with figure(8.0, 0.5 + 2.6 * len(panels)) as (canvas, stream):
        axes = canvas.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axis, panel in zip(axes, panels, strict=True):
            draw(axis, time, panel)
        axes[-1].set_xlabel("time [s]")
        canvas.align_ylabels(axes)
        canvas.savefig(stream, dpi=DOTS_PER_INCH)
        return stream.getvalue()


@contextmanager
def figure(width: float, height: float) -> Iterator[tuple[Figure, io.BytesIO]]:
    """Provide a figure of a size [inch] in the style of the report, and a stream to save it to."""
    with mpl.rc_context(STYLE):
        yield Figure(figsize=(width, height), layout="constrained"), io.BytesIO()


def draw(axis: Axes, time: FloatArray, panel: Panel) -> None:
    """Draw one diagram over time.

    Args:
        axis: where to.
        time: (steps,) [s].
        panel: the diagram.
    """
    for name, values in panel.lines.items():
        style = "steps-pre" if panel.steps else "default"
        (line,) = axis.plot(time, values, label=name, drawstyle=style)
        if name in panel.points:
            draw_points(axis, *panel.points[name], f"{name}, measured", str(line.get_color()))
    for name, level in panel.levels.items():
        axis.axhline(level, color="#8a8f98", linewidth=0.9, linestyle=(0, (6, 4)), zorder=1)
        axis.annotate(
            name,
            (1.0, level),
            xycoords=("axes fraction", "data"),
            xytext=(-2, 3),
            textcoords="offset points",
            ha="right",
            fontsize=8,
            color="#5b5f66",
        )
    low, high = axis.get_ylim()
    if high - low < panel.least:
        axis.set_ylim(-0.05 * panel.least, panel.least)
    if panel.logarithmic:
        axis.set_yscale("log", nonpositive="mask")
    axis.set_ylabel(panel.label)
    axis.margins(x=0.01)
    if panel.points:  # loggers begin early and end late
        axis.set_xlim(time[0], time[-1])
    if len(panel.lines) > 1 or not panel.label.startswith(tuple(panel.lines)):
        axis.legend(loc="best", ncols=2 if len(panel.lines) > 4 else 1)


def draw_points(
    axis: Axes, time: FloatArray, values: FloatArray, name: str, colour: str
) -> None:
    """Draw what was measured as open circles, of a long series every so many-th one.

    Args:
        axis: where to.
        time: of the points [s].
        values: there.
        name: in the legend.
        colour: that of the computed curve.
    """
    every = max(len(time) // MOST_POINTS, 1)
    axis.plot(
        time[::every], values[::every], linestyle="none", marker="o", markersize=4,
        markerfacecolor="none", color=colour, label=name, zorder=3,
    )  # fmt: skip


def row(
    images: Sequence[Image],
    titles: Sequence[str],
    label: str,
    limits: tuple[float, float],
    colours: str,
    beside: tuple[str, tuple[float, float], str] | None = None,
) -> bytes:
    """Return pictures side by side with one colour bar or two as PNG.

    Args:
        images: all of one size.
        titles: above them.
        label: of the colour bar, with its unit.
        limits: values at its ends.
        colours: name of the colour map.
        beside: label, limits and colours of a second bar.
    """
    images = trimmed(images)
    height, width = images[0].shape[:2]
    tall = min(3.4 * height / width, 4.2)
    wide = tall * width / height
    bars = [(label, limits, colours), *([] if beside is None else [beside])]
    with figure(len(images) * (wide + 0.15) + 1.1 * len(bars), tall + 0.55) as (canvas, stream):
        axes = canvas.subplots(1, len(images), squeeze=False)[0]
        for axis, image, title in zip(axes, images, titles, strict=True):
            axis.imshow(image, interpolation="antialiased")
            axis.set_title(title, fontsize=9)
            axis.axis("off")
        for text, ends, name in bars:
            scale = ScalarMappable(Normalize(*ends), name)
            bar = canvas.colorbar(scale, ax=list(axes), shrink=0.9, pad=0.02, aspect=25)
            bar.set_label(text)
            bar.ax.spines["outline"].set_visible(False)
        canvas.savefig(stream, dpi=DOTS_PER_INCH)
        return stream.getvalue()


def trimmed(images: Sequence[Image]) -> list[Image]:
    """Return pictures of one size without their common white margin."""
    drawn = np.any([np.any(image < 250, axis=2) for image in images], axis=0)
    rows, columns = (np.flatnonzero(drawn.any(axis=axis)) for axis in (1, 0))
    if rows.size == 0:
        return list(images)
    top, left = max(rows[0] - 8, 0), max(columns[0] - 8, 0)
    return [image[top : rows[-1] + 9, left : columns[-1] + 9] for image in images]
