"""Residual stress and distortion of the bodies where they were last there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from castx.report.summary.finding import Finding, Shown, place_text
from castx.results.reading import Results
from castx.results.states.quantities import PRINCIPAL, parts

RESIDUAL = "Residual stress"
AT_THE_END = "Stress at the end"


def last_ends(run: Results) -> Iterator[tuple[str, float, Mapping[str, Any]]]:
    """Yield body, time [s] and record of the last end of a stage of each body, castings first."""
    latest = {
        body: (float(end["time"]), found)
        for end in run.record.get("stage_ends", [])
        for body, found in end["bodies"].items()
    }
    freezing = run.freezing
    for body in sorted(latest, key=lambda name: name not in freezing):
        yield body, *latest[body]


def residual_stress(run: Results) -> Iterator[Finding]:
    """Yield the largest principal stress of each body at its last end.

    It is residual in a casting that is cold and free; a die bears what its process asks of it.
    """
    for body, time, found in last_ends(run):
        stress = found["stress"]
        pull, mises = stress["largest_principal"], stress["von_mises"]
        yield Finding(
            RESIDUAL if body in run.freezing else AT_THE_END, body, pull["value"], "MPa",
            f"Largest principal stress; von Mises at most {_mega(mises['value'])} at "
            f"{place_text(mises['place'], run.model)}, {_mega(stress['mean_von_mises'])} in the "
            "mean." + (" It is residual stress once the body is cold and free."
                       if body in run.freezing else ""),
            factor=1e-6, place=pull["place"], time=time,
            shown=Shown(PRINCIPAL[0], (body,), time),
        )  # fmt: skip


def distortion(run: Results) -> Iterator[Finding]:
    """Yield the largest deviation of each body from its nominal surface at its last end."""
    for body, time, found in last_ends(run):
        shape = found.get("distortion")
        if shape is None:
            continue
        out, into = shape["outward"], shape["inward"]
        most = max(out, into, key=lambda extreme: abs(extreme["value"]))
        shares = zip(parts("displacement", run.model), shape["allowance"], strict=False)
        yield Finding(
            "Distortion", body, most["value"], "mm",
            f"Deviation from the nominal surface, positive outward, from "
            f"{1e3 * into['value']:.3g} to {1e3 * out['value']:.3g} mm; allowance "
            + ", ".join(f"{axis} {100.0 * share:.3g} %" for axis, share in shares) + ".",
            factor=1e3, place=most["place"], time=time,
            shown=Shown("deviation", (body,), time, moved=True),
        )  # fmt: skip


def _mega(stress: float) -> str:
    return f"{1e-6 * stress:.3g} MPa"
