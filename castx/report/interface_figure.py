"""The heat-transfer coefficient of an interface of the database over its gap, as a figure."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.report.interface_law import heat_transfer_coefficient
from castx.report.material_figure import FORMATS
from castx.report.style import COLOURS, DOTS_PER_INCH, figure
from castx.transfer.database import InterfaceEntry, SourcedNumber, interface_entry

GAPS = np.logspace(-7, np.log10(3e-3), 200)
"""Gaps that are drawn [m]."""

TEMPERATURES = (100.0, 500.0, 900.0)
"""Of both faces, for which the coefficient is drawn [°C]."""

NOT_VARIED = ("law", "radiation")


def write_interface_figure(name: str, path: Path) -> None:
    """Draw the coefficient of an interface over its gap and write it as PNG, SVG or PDF.

    Raises:
        CaseError: no such interface, another ending, or a file that cannot be written.
    """
    entry = interface_entry(name)
    if path.suffix.lower() not in FORMATS:
        raise CaseError(f"cannot draw {path}: the name must end in {', '.join(FORMATS)}")
    with figure(6.4, 4.2) as (canvas, _):
        canvas.set_layout_engine("constrained", w_pad=0.12, h_pad=0.08)
        axis = canvas.subplots()
        low, high = band(entry)
        axis.fill_between(1e6 * GAPS, low, high, color="#e3e5e8", label="ranges of the numbers")
        for at, colour in zip(TEMPERATURES, COLOURS, strict=False):
            axis.plot(1e6 * GAPS, curve(entry.heat, at), color=colour, label=f"faces at {at:g} °C")
        axis.set(xscale="log", yscale="log", xlabel="gap [µm]", ylabel="coefficient [W/m²/K]")
        axis.margins(x=0.0)
        axis.legend(loc="lower left", fontsize=8, title="without radiation", title_fontsize=8)
        canvas.suptitle(name, fontweight="bold")
        try:
            canvas.savefig(path, dpi=DOTS_PER_INCH)
        except OSError as error:
            raise CaseError(f"cannot write {path}: {error.strerror}") from None


def curve(heat: dict[str, Any], temperature: float) -> FloatArray:
    """Return the coefficients over `GAPS` [W/m²/K], both faces at a temperature [°C]."""
    return heat_transfer_coefficient(heat, GAPS, secondary=temperature, primary=temperature)


def band(entry: InterfaceEntry) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest coefficients over `GAPS` that the ranges of numbers allow."""
    found = np.array([curve(heat, TEMPERATURES[0]) for heat in extremes(entry)])
    return found.min(axis=0), found.max(axis=0)


def extremes(entry: InterfaceEntry) -> Iterator[dict[str, Any]]:
    """Yield the heat transfer with all numbers of the law at ends of their ranges."""
    varied = [n for n in entry.numbers if n.name.partition(".")[0] not in NOT_VARIED]
    for ends in product((0, 1), repeat=len(varied)):
        heat = {k: dict(v) if isinstance(v, dict) else v for k, v in entry.heat.items()}
        for number, end in zip(varied, ends, strict=True):
            outer, _, inner = number.name.partition(".")
            place, key = (heat[outer], inner) if inner else (heat, outer)
            place[key] = end_of(number, end)
        yield heat


def end_of(number: SourcedNumber, end: int) -> float | list[float]:
    """Return the value at the lower (0) or upper (1) end of its range, of a list all of them."""
    ends = [limits[end] for limits in number.ranges]
    return ends if isinstance(number.value, list) else ends[0]
