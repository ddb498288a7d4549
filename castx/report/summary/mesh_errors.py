"""How far stress and heat flux of a body are off by its mesh, in the mean over the body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from castx.report.summary.finding import Finding, Shown
from castx.report.summary.solid import last_ends
from castx.results.reading import Results

STRESSED = 1.0
"""Stress below which a body bears none but by rounding [Pa]: no error is a share of that."""


def mesh_errors(run: Results) -> Iterator[Finding]:
    """Yield the relative errors of stress at the last end and of heat flux over the run."""
    for body, time, found in last_ends(run):
        known = found.get("stress_error")
        if known and known["size"] >= STRESSED:
            yield Finding(
                "Error of the stress by the mesh", body, known["relative"], "%",
                f"{_mega(known)} of {_mega(known, 'size')}, root mean squares over what is solid, "
                "by the difference from a recovered stress (Zienkiewicz and Zhu); single cells "
                "are off by more.",
                factor=100.0, time=time, shown=Shown("stress_error", (body,), time), of_mesh=True,
            )  # fmt: skip
    for body, known in run.record.get("flux_errors", {}).items():
        yield Finding(
            "Error of the heat flux by the mesh", body, known["relative"], "%",
            f"{1e-3 * known['error']:.3g} kW/m² of {1e-3 * known['size']:.3g} kW/m², root mean "
            "squares over body and time, by the difference from a recovered heat flux.",
            factor=100.0, shown=Shown("heat_flux_error", (body,)), of_mesh=True,
        )  # fmt: skip


def _mega(known: Mapping[str, Any], what: str = "error") -> str:
    return f"{1e-6 * known[what]:.3g} MPa"
