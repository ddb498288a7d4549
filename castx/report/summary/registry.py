"""All findings of a summary, in the order in which they are read.

A number of run.json or of the fields becomes part of every report, and of every comparison of
several runs, by a function that yields its findings where a run has them, entered here. The extreme
of a field needs one line in `castx.report.summary.risks.FIELD_RISKS` only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from castx.report.summary.coherency import coherency
from castx.report.summary.estimated import with_estimates
from castx.report.summary.finding import Finding
from castx.report.summary.freezing import freezing
from castx.report.summary.gaps import gaps
from castx.report.summary.measured import deviations, ejection
from castx.report.summary.mesh_errors import mesh_errors
from castx.report.summary.risks import alloy_risks, field_risks, hot_spots
from castx.report.summary.solid import distortion, residual_stress
from castx.report.summary.suctions import suctions
from castx.report.summary.thin_walls import thin_walls
from castx.results.reading import Results

Finder = Callable[[Results], Iterable[Finding]]

FINDERS: tuple[Finder, ...] = (
    freezing, hot_spots, field_risks, alloy_risks, gaps, suctions, residual_stress, distortion,
    ejection, deviations, coherency, thin_walls, mesh_errors,
)  # fmt: skip


def findings(run: Results) -> list[Finding]:
    """Return all findings of a run that has written fields or not, with errors if estimated."""
    return with_estimates((finding for find in FINDERS for finding in find(run)), run)


def leading(found: Iterable[Finding]) -> list[Finding]:
    """Return the first finding of each topic."""
    first: dict[str, Finding] = {}
    for finding in found:
        first.setdefault(finding.topic, finding)
    return list(first.values())
