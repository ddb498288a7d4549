"""What matters in a case: each answer of a study by the inputs that it hangs on, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.input.units import plain_text
from castx.studies.asked.vary import MORRIS, SOBOL
from castx.studies.effects import elementary, lines, variance_shares
from castx.studies.table import StudyTable

ENOUGH = 0.9
"""Share of the variance from which on straight lines tell an answer."""
LITTLE = 0.05
"""Share of the largest effect below which an input is said to matter little."""


@dataclass(frozen=True)
class InputEffect:
    """How an answer hangs on one input.

    Attributes:
        name: of the input.
        change: of the answer as the input goes from its lowest to its highest value, in the unit
            of the answer, all others being spread; of Morris μ.
        strength: what inputs are ranked by: of Sobol the total index, of Morris μ*, else the size
            of the change.
        more: further numbers, with their names.
    """

    name: str
    change: float
    strength: float
    more: dict[str, float]


@dataclass(frozen=True)
class Importance:
    """An answer and what it hangs on.

    Attributes:
        output: its name.
        unit: in which it is shown.
        low: smallest value of all runs.
        high: largest value.
        effects: of the inputs, the strongest first.
        remark: what the numbers do not tell; "" if nothing.
    """

    output: str
    unit: str
    low: float
    high: float
    effects: tuple[InputEffect, ...]
    remark: str

    @property
    def sentence(self) -> str:
        """The inputs that it hangs on, in words."""
        ends = f"{plain_text(self.low)} and {plain_text(self.high)}"
        span = f"{self.output} lies between {ends} {self.unit}".strip()
        known = [effect for effect in self.effects if np.isfinite(effect.strength)]
        if not known:
            return f"{span}."
        most = known[0].strength
        strong = [self._told(effect) for effect in known if effect.strength > LITTLE * most]
        weak = [effect.name for effect in known if effect.strength <= LITTLE * most]
        text = f"{span}; it hangs on {', then '.join(strong)}"
        matter = "matters" if len(weak) == 1 else "matter"
        return f"{text}; {' and '.join(weak)} {matter} little." if weak else f"{text}."

    def _told(self, effect: InputEffect) -> str:
        """Return an input with the change of the answer from its lowest to its highest value."""
        if not np.isfinite(effect.change):
            return effect.name
        sign = "+" if effect.change > 0.0 else ""
        return f"{effect.name} ({sign}{plain_text(effect.change, 2)} {self.unit}".rstrip() + ")"

    def as_json(self) -> dict[str, Any]:
        """Return all numbers with the types of JSON, None where there are none."""
        found = asdict(self)
        for effect in found["effects"]:
            effect["more"] = {key: _finite(value) for key, value in effect["more"].items()}
            effect["change"] = _finite(effect["change"])
            effect["strength"] = _finite(effect["strength"])
        return {**found, "effects": list(found["effects"]), "sentence": self.sentence}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def importance(table: StudyTable, points: FloatArray, method: str) -> list[Importance]:
    """Return the effects of all inputs on each answer that varies.

    Args:
        table: the runs.
        points: of the unit cube at which they lie, (runs, inputs).
        method: of the study.
    """
    return [_of(table, points, method, output) for output in table.varied()]


def _of(table: StudyTable, points: FloatArray, method: str, output: str) -> Importance:
    result = table.result(output)
    known = result[np.isfinite(result)]
    names = table.inputs
    if method == MORRIS:
        effects, remark = _paths(names, points, result)
    else:
        effects, remark = _spread(names, points, result, method)
    ranked = sorted(
        effects, key=lambda effect: -effect.strength if np.isfinite(effect.strength) else np.inf
    )
    failed = len(result) - len(known)
    if failed:
        told = f"{failed} of {len(result)} runs have not given it, and are left out."
        remark = f"{remark} {told}".strip()
    unit = table.unit(output)
    return Importance(output, unit, float(known.min()), float(known.max()), tuple(ranked), remark)


def _paths(
    names: Sequence[str], points: FloatArray, result: FloatArray
) -> tuple[list[InputEffect], str]:
    found = elementary(points, result)
    effects = [
        InputEffect(name, float(mean), float(strength), {"σ": float(spread)})
        for name, mean, strength, spread in zip(
            names, found.mean, found.strength, found.spread, strict=True
        )
    ]
    return effects, ""


def _spread(
    names: Sequence[str], points: FloatArray, result: FloatArray, method: str
) -> tuple[list[InputEffect], str]:
    straight = lines(points, result)
    nothing = np.full(len(names), np.nan)
    slopes = nothing if straight is None else straight.slopes
    strength, more = np.abs(slopes), [dict[str, float]() for _ in names]
    remark = ""
    if straight is None:
        remark = "There are too few runs to tell the inputs apart: more draws are needed."
    elif straight.explained < ENOUGH and method != SOBOL:
        remark = (
            f"Straight lines explain {100 * straight.explained:.0f} % of it only: it bends, or "
            'inputs act together; method = "sobol" tells more.'
        )
    shares = variance_shares(points, result) if method == SOBOL else None
    if shares is not None:
        strength = shares.total
        more = [
            {"first-order index": float(first), "total index": float(total)}
            for first, total in zip(shares.first, shares.total, strict=True)
        ]
    effects = [
        InputEffect(name, float(slopes[k]), float(strength[k]), more[k])
        for k, name in enumerate(names)
    ]
    return effects, remark
