"""Pictures of the same finding of several runs, in the same colours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from castx.errors import CaseError
from castx.report.display import display
from castx.report.page.shots import Limits, Shot, finding_limits, finding_shot
from castx.report.reported import ReportedRun
from castx.report.summary.finding import Finding
from castx.report.summary.registry import leading

Findings = Mapping[str, Finding]


@dataclass(frozen=True)
class PictureRow:
    """The pictures of a finding.

    Attributes:
        name: of the finding.
        shots: of each run; None: it has none.
    """

    name: str
    shots: Sequence[Shot | None]


def picture_rows(runs: Sequence[tuple[ReportedRun, Findings]]) -> list[PictureRow]:
    """Return pictures of the first finding of each topic that at least two of the runs have.

    Args:
        runs: results with their findings by name.

    Raises:
        CaseError: pictures cannot be drawn.
    """
    drawn = [(run, found if has_fields(run, found) else {}) for run, found in runs]
    names = [finding.name for finding in leading(first_of_each(drawn).values())]
    if not names:
        return []
    with display():
        rows = [row_of(drawn, name) for name in names]
    return [row for row in rows if sum(shot is not None for shot in row.shots) > 1]


def first_of_each(runs: Sequence[tuple[ReportedRun, Findings]]) -> dict[str, Finding]:
    """Return the findings with a picture that several runs have, as the first of them has them."""
    shared: dict[str, Finding] = {}
    for _, found in runs:
        for name, finding in found.items():
            if finding.shown is not None and sum(name in other for _, other in runs) > 1:
                shared.setdefault(name, finding)
    return shared


def has_fields(run: ReportedRun, found: Findings) -> bool:
    """Return whether there is something to draw."""
    if all(finding.shown is None for finding in found.values()):
        return False
    try:
        return bool(run.times)
    except CaseError:
        return False


def row_of(runs: Sequence[tuple[ReportedRun, Findings]], name: str) -> PictureRow:
    """Return the pictures of one finding, between the extremes of all runs."""
    limits = common(
        [finding_limits(run, found[name]) if name in found else {} for run, found in runs]
    )
    return PictureRow(
        name,
        [finding_shot(run, found[name], limits) if name in found else None for run, found in runs],
    )


def common(found: Sequence[Mapping[str, Limits]]) -> dict[str, Limits]:
    """Return the least and the largest end of the colours of several pictures, by the colours."""
    names = dict.fromkeys(name for limits in found for name in limits)
    ends = {name: [limits[name] for limits in found if name in limits] for name in names}
    return {
        name: (min(low for low, _ in of), max(high for _, high in of)) for name, of in ends.items()
    }
