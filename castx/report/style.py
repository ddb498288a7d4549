"""The style of figures, drawn with matplotlib without a display."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.rcsetup import cycler

DOTS_PER_INCH = 150
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


@contextmanager
def figure(width: float, height: float) -> Iterator[tuple[Figure, io.BytesIO]]:
    """Provide a figure of a size [inch] in the style of the report, and a stream to save it to."""
    with mpl.rc_context(STYLE):
        yield Figure(figsize=(width, height), layout="constrained"), io.BytesIO()
