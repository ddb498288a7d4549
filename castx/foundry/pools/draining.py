"""Flow of liquid out of the highest places of a pool while the pool freezes, within a step.

Of what freezes at the rate ΔF the share β is lacking, and comes from the liquid G of the highest
place, of which the share λ is left. Both fall linearly in a step of implicit Euler, so that, with R
what freezes below,
    G dλ/ds = -β (R + λ ΔF), G = G_0 - ΔF s, hence R + λ ΔF = (R + ΔF) (G/G(s_0))^β
from s_0 on, when the place above was empty. Whole steps are found so, however many places they
empty.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Draining:
    """Liquid left in the highest places of a pool after a step.

    Attributes:
        left: share λ of its liquid that has not flowed out of each place at the end, (places,).
        mean: of that share over the step, (places,); it is what has frozen.
    """

    left: FloatArray
    mean: FloatArray


def drained(liquid: FloatArray, freezing: FloatArray, below: float, contraction: float) -> Draining:
    """Return the liquid left in the highest places of a pool after a step of freezing.

    Args:
        liquid: G_0, volume of liquid in each place when the step begins, the highest place first,
            (places,) [m³].
        freezing: ΔF, how much of it freezes in the step if none flows out, (places,) [m³].
        below: what freezes in the step in the rest of the pool [m³]; negative where less flows than
            the places lack.
        contraction: β = (ρ_s - ρ_l)/ρ_l.
    """
    left, mean = np.ones(len(liquid)), np.ones(len(liquid))
    rests = below + freezing.sum() - np.cumsum(freezing)
    start = 0.0
    for place, (volume, own, rest) in enumerate(
        zip(liquid, freezing, np.maximum(rests, min(below, 0.0)), strict=True)
    ):
        found = _one(float(volume), float(own), float(rest), contraction, start)
        left[place], mean[place], start = found
        if start >= 1.0:
            break
    return Draining(left, mean)


def _one(
    volume: float, freezing: float, rest: float, contraction: float, start: float
) -> tuple[float, float, float]:
    """Return share left, its mean over the step, and the part of the step after which it is empty.

    That part is one where it does not become empty. Arguments as above; `start`: the part of the
    step that had gone by when the place above was empty.
    """
    now = volume - freezing * start
    if now <= 0.0:
        return 1.0, 1.0, start
    demand = rest + freezing
    if demand <= 0.0:
        return 1.0, 1.0, 1.0
    if freezing <= 0.0:
        emptied = start + now / (contraction * demand)
        if emptied < 1.0:
            return 0.0, start + 0.5 * (emptied - start), emptied
        left = 1.0 - contraction * demand * (1.0 - start) / now
        return left, start + 0.5 * (1.0 + left) * (1.0 - start), 1.0
    end = 1.0
    fallen = freezing * (1.0 - start) / now
    logarithm = np.log1p(-fallen) if fallen < 1.0 else -np.inf
    left = 1.0 + demand / freezing * np.expm1(contraction * logarithm)
    if left <= 0.0:
        left, logarithm = 0.0, np.log(rest / demand) / contraction if rest > 0.0 else -np.inf
        end = min(1.0, start - now * np.expm1(logarithm) / freezing)
    # ∫ (R + λ ΔF) ds, of which R is known: what is left of it has frozen here.
    sum_of_both = -demand * now / freezing * np.expm1((1.0 + contraction) * logarithm)
    frozen = sum_of_both / (1.0 + contraction) - rest * (end - start)
    return float(left), start + float(frozen) / freezing, float(end)
