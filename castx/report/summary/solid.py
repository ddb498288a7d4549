"""Residual stress and distortion of the bodies where they were last there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from castx.input.units import plain_text, seconds_text
from castx.report.summary.finding import Finding, Shown, place_text
from castx.report.summary.freezing import taken_out
from castx.results.reading import Results
from castx.results.states.quantities import PRINCIPAL, parts

RESIDUAL = "Residual stress"
AT_THE_END = "Stress at the end"
COLD = 100.0
"""Temperature up to which a casting counts as cold [°C]: what it shrinks by then is little."""


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

    It is residual in a casting that is cold and free and whose law can yield; else the sentence
    says why it is not. A die bears what its process asks of it.
    """
    for body, time, found in last_ends(run):
        stress = found["stress"]
        pull, mises = stress["largest_principal"], stress["von_mises"]
        casting = body in run.freezing
        doubts = list(not_residual(run, body, time, found)) if casting else []
        told = "".join(f" {doubt}" for doubt in doubts)
        if casting and not doubts:
            told = " The body is cold and free: this is residual stress."
        yield Finding(
            RESIDUAL if casting and not doubts else AT_THE_END, body, pull["value"], "MPa",
            f"Largest principal stress{_most(stress.get('high_principal'))}; von Mises at most "
            f"{_mega(mises['value'])} at {place_text(mises['place'], run.model)}, "
            f"{_mega(stress['mean_von_mises'])} in the mean{_most(stress.get('high_von_mises'))}."
            + told + "".join(beyond_strength(run, body, pull["value"])) + _gone(run, body, time),
            factor=1e-6, place=pull["place"], time=time,
            shown=Shown(PRINCIPAL[0], (body,), time),
        )  # fmt: skip


def not_residual(run: Results, body: str, time: float, found: Mapping[str, Any]) -> Iterator[str]:
    """Yield why the stress of a casting is no residual stress, as sentences.

    Args:
        run: the results.
        body: the casting.
        time: of its last end [s].
        found: the record of this end.
    """
    if run.record["bodies"][body].get("law") == "thermo-elastic":
        yield f"{body} is elastic (law): it cannot yield, and its stress is far too large."
    hottest = found.get("hottest")
    if hottest is not None and hottest > COLD:
        yield f"{body} is still up to {hottest:.0f} °C hot: what remains when it is cold differs."
    if found.get("hindered"):
        yield f"Supports hold {body}, so that it cannot shrink evenly: a part is theirs."
    elif run.model == "plane-strain":
        yield "The model holds it across the plane; generalised-plane-strain does not."
    for interface in run.record["interfaces"]:
        closed = run.history.get(f"{interface}.closed_fraction")
        if body not in interface.split("/") or closed is None:
            continue
        touching = float(np.interp(time, run.history["time"], closed))
        if touching > 0.0:
            other = next(name for name in interface.split("/") if name != body)
            yield f"{other} still holds it, at {100.0 * touching:.0f} % of their interface."


def beyond_strength(run: Results, body: str, stress: float) -> Iterator[str]:
    """Yield a sentence on a stress [Pa] beyond the strength of the material of a body."""
    strength = run.record["bodies"][body].get("tensile_strength")
    if strength is not None and stress > strength:
        yield f" No {run.record['bodies'][body]['material']} bears more than {_mega(strength)}."


def _gone(run: Results, body: str, time: float) -> str:
    if taken_out(run, body) is None:
        return ""
    return f" {body} was removed: this is its state at {seconds_text(time)}."


def _most(stress: float | None) -> str:
    return "" if stress is None else f" (99 % of the volume below {_mega(stress)})"


def distortion(run: Results) -> Iterator[Finding]:
    """Yield the largest deviation of each body from its nominal surface at its last end.

    Its size is the number, so that runs are compared, and the least is wanted, whichever way it
    goes.
    """
    for body, time, found in last_ends(run):
        shape = found.get("distortion")
        if shape is None:
            continue
        out, into = shape["outward"], shape["inward"]
        most = max(out, into, key=lambda extreme: abs(extreme["value"]))
        axes = parts("displacement", run.model)
        yield Finding(
            "Distortion", body, abs(most["value"]), "mm",
            f"Largest deviation from the nominal surface; positive outward, it goes from "
            f"{1e3 * into['value']:.3g} to {1e3 * out['value']:.3g} mm; allowance "
            + ", ".join(map(_allowance, axes, shape["allowance"])) + "." + _gone(run, body, time),
            factor=1e3, place=most["place"], time=time,
            shown=Shown("deviation", (body,), time, moved=True),
        )  # fmt: skip


def _allowance(axis: str, share: float | None) -> str:
    if share is None:
        return f"{axis} unknown, as no faces across it lie apart"
    return f"{axis} {100.0 * share:.3g} %"


def _mega(stress: float) -> str:
    return f"{plain_text(1e-6 * stress, 3)} MPa"
