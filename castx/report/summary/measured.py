"""Deviations of computed curves from measured ones, and forces that draw bodies."""

from __future__ import annotations

from collections.abc import Iterator

from castx.input.units import seconds_text
from castx.report.summary.finding import Finding
from castx.results.reading import Results
from castx.results.states.quantities import UNITS

SHOWN = {
    "temperature": (1.0, "K"), "displacement": (1e6, "µm"), "gap": (1e6, "µm"),
    "pressure": (1e-6, "MPa"), "stress": (1e-6, "MPa"), "von_mises": (1e-6, "MPa"),
    "contact_pressure": (1e-6, "MPa"),
}  # fmt: skip
"""Factor from SI, and unit, of differences between quantities; others are in SI."""


def deviations(run: Results) -> Iterator[Finding]:
    """Yield the root mean square of computed minus measured curves, the largest first."""
    found = run.deviations
    for name in sorted(found, key=lambda column: -found[column].root_mean_square):
        apart, quantity = found[name], name.split(".")[1]
        factor, unit = SHOWN.get(quantity, (1.0, UNITS[quantity]))
        yield Finding(
            "Beside its measurement", name, apart.root_mean_square, unit,
            f"Root mean square of computed minus measured at {apart.points} points, at most "
            f"{factor * apart.largest:+.3g} {unit} at {seconds_text(apart.at)}.",
            factor=factor,
        )  # fmt: skip


def ejection(run: Results) -> Iterator[Finding]:
    """Yield the forces that draw bodies, each where it was last drawn."""
    drawn = {
        body: (float(event["time"]), found)
        for event in run.record.get("process", [])
        for body, found in event.get("ejection", {}).items()
    }
    for body, (time, found) in drawn.items():
        yield Finding(
            "Force to draw", body, found["force"], "kN",
            f"Friction {found['friction']:g} times normal forces of {1e-3 * found['normal']:.3g} "
            "kN, without draught and adhesion.",
            factor=1e-3, time=time,
        )  # fmt: skip
