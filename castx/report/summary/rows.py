"""Further rows of a summary, as pairs of name and text: course of the process, and effort."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import timedelta

import numpy as np

from castx.report.stages import process_rows
from castx.results.reading import Results

Rows = list[tuple[str, str]]


def further_rows(run: Results) -> Rows:
    """Return rows with the simulated time of a run, doubts, and the stages of its process."""
    record = run.record
    rows = [("simulated", f"{record['time_reached']:g} of {record['end']:g} s")]
    rows += [("in doubt", doubt) for doubt in run.doubts]
    return rows + list(process_rows(record.get("process", [])))


def numeric_rows(run: Results) -> Rows:
    """Return errors of the balances, and the effort of a run."""
    record, history = run.record, run.history
    rows = []
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
    """Return the number of steps of a run and of their rejected tries as text."""
    text = f"{counts['steps']}, {counts['cutbacks']} of them cut"
    repeats = counts.get("repeats", 0)  # not in the results of earlier versions
    return f"{text}, {repeats} taken again" if repeats else text
