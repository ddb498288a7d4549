"""Choice of sensors out of many: D- and A-optimal, one after another.

Each sensor lies at a depth that is known to a deviation only; what it tells of the parameters is
what is left when its depth is fitted with them. Source: F. Pukelsheim, Optimal Design of
Experiments (2006); a greedy choice is near the best one, not always the best.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.identification.covariance import weighted

DEPTH = 3e-4
"""Usual deviation of the depth of a thermocouple in a drilled hole [m]: a choice."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A place for a sensor.

    Attributes:
        name: of the place.
        sensitivity: J of its samples, (samples, parameters).
        by_depth: their change by its depth δ, (samples,) [K/m].
        noise: σ of its samples [K], one number or (samples,).
        depth_deviation: prior deviation of δ [m]; 0: the depth is known.
    """

    name: str
    sensitivity: FloatArray
    by_depth: FloatArray
    noise: FloatArray
    depth_deviation: float = DEPTH

    def information(self) -> FloatArray:
        """Return Jᵀ W J - Jᵀ W d (dᵀ W d + 1/σ_δ²)⁻¹ dᵀ W J, (parameters, parameters)."""
        changes = weighted(self.sensitivity, self.noise)
        depth = weighted(self.by_depth[:, None], self.noise)[:, 0] * self.depth_deviation
        mixed = changes.T @ depth
        return np.asarray(changes.T @ changes - np.outer(mixed, mixed) / (depth @ depth + 1.0))


def d_optimal(candidates: Sequence[Candidate], number: int, prior: FloatArray) -> tuple[str, ...]:
    """Return the sensors that raise ln det C⁻¹ most, in the order of their choice.

    Args:
        candidates: places, each taken once at most.
        number: how many sensors.
        prior: Γ of the parameters, positive definite.

    Raises:
        ValueError: there are fewer candidates.
    """
    return _greedy(candidates, number, prior, lambda told: -float(np.linalg.slogdet(told)[1]))


def a_optimal(
    candidates: Sequence[Candidate], number: int, prior: FloatArray, wanted: Sequence[int]
) -> tuple[str, ...]:
    """Return the sensors that lower tr C of the wanted parameters most, in the order of choice.

    Args:
        candidates: places, each taken once at most.
        number: how many sensors.
        prior: Γ of the parameters, positive definite.
        wanted: columns of the parameters that matter.

    Raises:
        ValueError: there are fewer candidates.
    """
    columns = list(wanted)

    def spread(told: FloatArray) -> float:
        return float(np.trace(np.linalg.inv(told)[np.ix_(columns, columns)]))

    return _greedy(candidates, number, prior, spread)


def _greedy(
    candidates: Sequence[Candidate],
    number: int,
    prior: FloatArray,
    cost: Callable[[FloatArray], float],
) -> tuple[str, ...]:
    if number > len(candidates):
        raise ValueError(f"{number} sensors are wanted of {len(candidates)} candidates")
    told, left, names = np.linalg.inv(prior), list(candidates), []
    for _ in range(number):
        best = min(left, key=lambda candidate: cost(told + candidate.information()))
        told = told + best.information()
        left.remove(best)
        names.append(best.name)
    return tuple(names)
