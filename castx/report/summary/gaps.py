"""The largest gap of each interface: how wide, when and where."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from castx.errors import CaseError
from castx.input.units import seconds_text
from castx.report.summary.finding import Finding, Shown
from castx.results.field_times import OPEN
from castx.results.reading import Results

ROUNDING = 1e-9
"""A gap that counts as zero [m]: what the equilibrium leaves of it."""


def gaps(run: Results) -> Iterator[Finding]:
    """Yield the largest gap of each interface over the run, the widest interface first."""
    if run.record["scheme"] == "thermal":  # it knows no gaps
        return
    found = [gap for name in run.interfaces if (gap := largest_gap(run, name)) is not None]
    yield from sorted(found, key=lambda gap: -gap.value)


def largest_gap(run: Results, name: str) -> Finding | None:
    """Return the largest gap of an interface; None where none was recorded."""
    widths = run.history.get(f"{name}.max_gap")
    if widths is None or not np.isfinite(widths).any():
        return None
    widest = int(np.nanargmax(widths))
    value, time = float(widths[widest]), float(run.history["time"][widest])
    if value <= ROUNDING:
        return Finding("Largest gap", name, 0.0, "µm", "Its surfaces touch all the time.")
    opened = np.flatnonzero(widths > OPEN)
    told = "Largest opening of the run"
    if opened.size:
        since = float(run.history["time"][opened[0]])
        told += f"; it exceeds 1 µm first in the step to {seconds_text(since)}"
    written, place = gap_place(run, name, time)
    if place is not None and abs(written - time) > 1e-6 * time:
        told += f"; the place is that in the fields of {seconds_text(written)}"
    casting = name.split("/")[0]
    space = run.model == "3d"
    field = "gap" if space else "temperature"  # in the plane the gap itself is seen
    return Finding(
        "Largest gap", name, value, "µm", f"{told}.", factor=1e6, place=place, time=time,
        shown=Shown(field, (casting,), time, moved=not space, outside=space),
    )  # fmt: skip


def gap_place(run: Results, name: str, time: float) -> tuple[float, Sequence[float] | None]:
    """Return the time of fields nearest to a time, and where an interface was widest then.

    The place is None where the gap was not written, or one of the bodies is gone.
    """
    written = min(run.times, key=lambda found: abs(found - time))
    try:
        fields = run.interface(name, written)
    except CaseError:  # a body is gone by then
        return written, None
    gap = fields.values.get("gap")
    if gap is None or gap.size == 0:
        return written, None
    return written, [float(x) for x in fields.points[int(np.argmax(gap))]]
