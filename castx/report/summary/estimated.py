"""How far the numbers of a run are off, by its mesh and by its steps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from castx.report.summary.finding import Finding
from castx.results.files.estimate import Estimate, read_estimate
from castx.results.reading import Results


def with_estimates(found: Iterable[Finding], run: Results) -> list[Finding]:
    """Return findings with the estimates of their errors, where the run has any.

    Args:
        found: findings of the run.
        run: the results.
    """
    estimate = read_estimate(run.folder)
    if estimate is None or run.record.get("time_reached") != estimate.reached:
        return list(found)  # also where a run has gone on without estimates
    return [replace(finding, error=error_text(finding, estimate)) for finding in found]


def error_text(finding: Finding, estimate: Estimate) -> str:
    """Return by how much a number is off, such as "± 2 s by the mesh, ± 0.4 s by the steps"."""
    texts = zip(("mesh", "steps"), error_texts(finding, estimate), strict=True)
    return ", ".join(f"{text} by the {what}" for what, text in texts if text)


def error_texts(finding: Finding, estimate: Estimate) -> tuple[str, str]:
    """Return by how much a number is off by the mesh and by the steps.

    Without a sign: it changes from mesh to mesh, with the place of a front in its cell. Nothing is
    said of a number that is the same in all runs, that no other run has, or that is of the mesh.
    """
    if finding.of_mesh or estimate.values.get(finding.name) != finding.value:
        return "", ""
    by_mesh, by_steps = estimate.changes(finding.name)
    if not (by_mesh or by_steps):
        return "", ""
    return _size(finding, by_mesh), _size(finding, by_steps)


def _size(finding: Finding, change: float | None) -> str:
    if change is None:
        return ""
    return f"± {abs(finding.factor * change):.2g} {finding.unit}".strip()
