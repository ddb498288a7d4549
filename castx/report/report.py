"""report.html: one file with the numbers, curves and pictures of a run."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import timedelta
from pathlib import Path

import jinja2
import numpy as np

from castx.arrays import FloatArray
from castx.report.figures import NUMERICS, curve_figures, field_figures
from castx.report.hot_spots import hot_spot_table
from castx.report.solid import solid_rows
from castx.report.stages import process_rows
from castx.results.files.folder import REPORT, write_whole
from castx.results.files.measurements import Deviation
from castx.results.quantities import UNITS
from castx.results.reading import Results
from castx.results.snapshot import FULLY_SOLID

ROUNDING = 1e-15
"""Round-off: a gap that counts as zero [m]."""


SHOWN = {
    "temperature": (1.0, "K"), "displacement": (1e6, "µm"), "gap": (1e6, "µm"),
    "pressure": (1e-6, "MPa"), "stress": (1e-6, "MPa"), "von_mises": (1e-6, "MPa"),
    "contact_pressure": (1e-6, "MPa"),
}  # fmt: skip
"""Factor from SI, and unit, of differences between quantities; others are in SI."""


def write_report(folder: Path) -> Path:
    """Write report.html into a results folder and return its path.

    Raises:
        CaseError: the folder holds no results, or pictures cannot be drawn.
    """
    run = Results(folder)
    loader = jinja2.PackageLoader("castx.report", "templates")
    template = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined
    ).get_template("report.html.j2")
    curves = curve_figures(run)
    text = template.render(
        record=run.record,
        ended=run.record["exit"],
        summary=summary(run),
        hot_spots=hot_spot_table(run.record.get("hot_spots", []), run.model),
        curves=[figure for figure in curves if figure.title != NUMERICS],
        numerics=[figure for figure in curves if figure.title == NUMERICS],
        pictures=field_figures(run),
    )
    target = folder / REPORT
    write_whole(target, text)
    return target


def summary(run: Results) -> list[tuple[str, str]]:
    """Return the most important numbers of a run, as pairs of name and text."""
    record, history = run.record, run.history
    rows = [("simulated", f"{record['time_reached']:g} of {record['end']:g} s")]
    for body in run.freezing:
        rows.append((f"{body} all solid", solid_text(history, body)))
    coupled = record["scheme"] != "thermal"  # a run without mechanics knows no gaps
    for name in record["interfaces"] if coupled else ():
        largest = history.get(f"{name}.max_gap")
        if largest is not None:
            rows.append((f"largest gap {name}", gap_text(largest)))
            rows.append((f"{name} begins to open", opening_text(history["time"], largest)))
    rows += [(f"{name} beside its measurement", deviation_text(name, apart))
             for name, apart in run.deviations.items()]
    rows += process_rows(record.get("process", []))
    rows += solid_rows(record.get("stage_ends", []), run.model)
    if "energy_error" in history:
        rows.append(("energy error", f"{np.abs(history['energy_error']).max():.1e}"))
    errors = [values for name, values in history.items() if name.endswith(".force_error")]
    if errors:
        rows.append(("force error", f"{np.nanmax(errors):.1e}"))
    counts, memory = record["totals"], record["peak_memory"]
    wall = timedelta(seconds=round(record["wall"]))
    rows += [
        ("steps", steps_text(counts)),
        (
            "iterations",
            f"{counts['heat_iterations']} heat, {counts['mechanics_iterations']} mechanics, "
            f"in {counts['passes']} passes",
        ),
        ("wall clock time", f"{wall} on {record['ranks']} rank{'s' * (record['ranks'] > 1)}"),
        ("peak memory", f"{memory.get('all_ranks', 0) / 2**20:.0f} MiB, all ranks"),
    ]
    return rows


def steps_text(counts: Mapping[str, int]) -> str:
    """Return the steps of a run and how many tries of them were in vain."""
    text = f"{counts['steps']}, {counts['cutbacks']} of them cut"
    repeats = counts.get("repeats", 0)  # not in the results of earlier versions
    return f"{text}, {repeats} taken again" if repeats else text


def gap_text(largest: FloatArray) -> str:
    """Return the largest gap at the end, or before a body was removed."""
    known = largest[np.isfinite(largest)]
    when = "at the end" if np.isfinite(largest[-1]) else "before a body was removed"
    gap = known[-1] if known[-1] > ROUNDING else 0.0
    return f"{1e6 * gap:.4g} µm {when}"


def deviation_text(name: str, apart: Deviation) -> str:
    """Return how far a column of probes.csv is from what was measured."""
    quantity = name.split(".")[1]
    factor, unit = SHOWN.get(quantity, (1.0, UNITS[quantity]))
    return (
        f"RMS {factor * apart.root_mean_square:.3g} {unit}, at most "
        f"{factor * apart.largest:+.3g} {unit} at {apart.at:.4g} s, {apart.points} points"
    )


def solid_text(history: Mapping[str, FloatArray], body: str) -> str:
    """Return when a body was all solid, interpolated in its step."""
    time, fraction = history["time"], history[f"{body}.solid_fraction"]
    solid = np.flatnonzero(fraction >= FULLY_SOLID)
    if solid.size == 0:
        return f"not yet, {100.0 * fraction[-1]:.1f} % solid at the end"
    return f"between {time[max(solid[0] - 1, 0)]:.4g} and {time[solid[0]]:.4g} s"


def opening_text(time: FloatArray, gap: FloatArray) -> str:
    """Return when the largest gap of an interface first exceeded a micrometre."""
    opened = np.flatnonzero(gap > 1e-6)
    return f"at {time[opened[0]]:.4g} s (1 µm)" if opened.size else "never (1 µm)"
