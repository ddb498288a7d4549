"""Strain of a plate that freezes from its wall, in coordinates that follow the front.

Of the plate of `freezing_plate.py`, in its dimensionless quantities, 0 ≤ x ≤ X(t) is solid and the
rest stands at the melting point. With ξ = x/X (H. G. Landau, Heat conduction in a melting solid,
1950) the solid is 0 ≤ ξ ≤ 1 at all times,

    ∂T/∂t = T_ξξ/X² + ξ (dX/dt)/X T_ξ,   T_ξ = Bi X (T + 1) at ξ = 0,   T = 0 at ξ = 1,
    dX/dt = Ste T_ξ(1)/X,   dε/dt = (1/X) ∫ ∂T/∂t dx = (T_ξ(1) − T_ξ(0))/X².

Once X = 1 the plate is solid, and T_ξ(1) = 0. T is a polynomial that meets these equations at the
points of Chebyshev. Time is left to a method of variable order for stiff equations, and once all
is solid to the exponential of a matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from castx.arrays import FloatArray

FIRST = 1e-5
"""Skin of the beginning, over L: so thin that its temperature is linear."""


@dataclass(frozen=True)
class FreezingFront:
    """A plate that freezes from its wall and cools.

    Attributes:
        biot: h L/k.
        stefan: Ste = c ΔT/latent heat.
        degree: of the polynomial that the temperature is.
    """

    biot: float
    stefan: float
    degree: int = 10

    def strains(self, times: FloatArray) -> FloatArray:
        """Return the lateral strain over α ΔT at rising a t/L² from 0 on, (times,)."""
        first = FIRST / (self.stefan * self.biot)
        skin = -self.biot * FIRST * (1.0 - self._points)
        start = np.append(skin[1:-1], [FIRST, -self.biot * FIRST**2 / 2.0])
        growing = solve_ivp(
            self._freezing, (first, max(times[-1], 2.0 * first)), start, "BDF",
            events=_left_to_freeze, dense_output=True, rtol=1e-8, atol=1e-14,
        )  # fmt: skip
        through = growing.t[-1]
        *_, position, moment = growing.sol(np.clip(times, first, through))
        found = np.where(times < first, 0.0, moment / position)
        later = times > through
        solid = np.append(growing.y[:-2, -1], growing.y[-1, -1])
        found[later] = [self._cooled(solid, time - through) for time in times[later]]
        return np.asarray(found)

    def _cooled(self, solid: FloatArray, time: float) -> float:
        """Return ε some time after all has become solid, from inner temperatures and ε."""
        count = len(solid)
        none = self._cooling(np.zeros(count))
        rates = np.zeros((count + 1, count + 1))
        rates[:-1, :-1] = np.array([self._cooling(one) - none for one in np.eye(count)]).T
        rates[:-1, -1] = none
        return float((expm(rates * time) @ np.append(solid, 1.0))[-2])

    def _freezing(self, time: float, state: FloatArray) -> FloatArray:
        """Return the rates of the inner temperatures, of X and of X ε."""
        position, moment = state[-2:]
        temperature = np.concatenate([[0.0], state[:-2], [0.0]])
        at_wall = self._slopes[0]
        temperature[0] = (at_wall @ temperature / position - self.biot) / (
            self.biot - at_wall[0] / position
        )
        slope = self._slopes @ temperature
        speed = self.stefan * slope[-1] / position
        rate = (self._slopes @ slope / position + self._points * speed * slope) / position
        strain = (slope[-1] - slope[0]) / position**2
        return np.concatenate([rate[1:-1], [speed, strain * position + speed * moment / position]])

    def _cooling(self, state: FloatArray) -> FloatArray:
        """Return the rates of the inner temperatures and of ε, X = 1."""
        temperature = np.concatenate([[0.0], state[:-1], [0.0]])
        ends, wall = self._slopes[[0, -1]], np.array([self.biot, 0.0])
        temperature[[0, -1]] = np.linalg.solve(
            ends[:, [0, -1]] - np.diag(wall), wall - ends @ temperature
        )
        slope = self._slopes @ temperature
        return np.append((self._slopes @ slope)[1:-1], -slope[0])

    @cached_property
    def _points(self) -> FloatArray:
        return np.asarray(0.5 * (chebyshev.chebpts2(self.degree + 1) + 1.0))

    @cached_property
    def _slopes(self) -> FloatArray:
        """Return the matrix from values at the points to derivatives there."""
        points = chebyshev.chebpts2(self.degree + 1)
        values = chebyshev.chebvander(points, self.degree)
        modes = chebyshev.chebder(np.eye(self.degree + 1))
        derivatives = chebyshev.chebvander(points, self.degree - 1) @ modes
        return np.asarray(2.0 * np.linalg.solve(values.T, derivatives.T).T)


def _left_to_freeze(time: float, state: FloatArray) -> float:
    return float(1.0 - state[-2])


_left_to_freeze.terminal = True  # type: ignore[attr-defined]
