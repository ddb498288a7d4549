"""Laws of the heat transfer at interfaces written as Python functions, for drivers.

A case file contains only data and is never executed, so a driver passes such a law to
`Simulation.from_case`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.transfer.conductance import (
    PRIMARY,
    SECONDARY,
    VARIABLES,
    Conductance,
    Faces,
    touching,
)
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState

Coefficient = Callable[[FloatArray, FloatArray, FloatArray, FloatArray, float], FloatArray]
Slopes = Callable[
    [FloatArray, FloatArray, FloatArray, FloatArray, float], tuple[FloatArray, FloatArray]
]

SAMPLES = 200
LARGEST_GAP, LARGEST_PRESSURE = 2e-3, 2e8
COLDEST, HOTTEST = 0.0, 1600.0
"""Ranges in which a law is tried: gaps [m], pressures [Pa] and temperatures [°C]."""

DIFFERENCE = 1e-3
"""Step of temperature over which slopes are differenced [K]."""

SLOPE_ERROR = 1e-4
"""Largest error of a slope, relative to itself plus the coefficient per 100 K."""

CLOSURE_JUMP = 1e-6
"""Largest relative jump of the coefficient between a closed pair and one open by 1e-12 m."""


@dataclass(frozen=True)
class UserLaw:
    """A heat-transfer coefficient as a function of gap, pressure, temperatures and time.

    The law is checked at construction, for closed and open pairs at many temperatures.

    >>> from mpi4py import MPI
    >>> import castx
    >>> def through_air(gap, pressure, secondary, primary, time):
    ...     return 1.0 / (1.0 / 2300.0 + gap / 0.05)
    >>> case = castx.load_case("cylinder.toml", ["time.end=0.05", "geometry.size=1e-2"])
    >>> laws = {"casting/mould": castx.UserLaw(through_air)}
    >>> simulation = castx.Simulation.from_case(case, MPI.COMM_SELF, laws)
    >>> for state in simulation:
    ...     coefficient = state.paired("casting/mould", "heat_transfer_coefficient")
    >>> bool((coefficient <= 2300.0).all())
    True
    >>> castx.UserLaw(lambda gap, pressure, secondary, primary, time: -gap)
    Traceback (most recent call last):
    castx.errors.CaseError: a heat-transfer coefficient must be finite and not negative; ...

    Args:
        coefficient: takes gap [m], contact pressure [Pa], temperatures of the secondary and the
            primary face [°C], each of shape (pairs,), and time [s]; returns h [W/m²/K], (pairs,).
        slopes: takes the same and returns the derivatives of h over both temperatures; None: they
            are differenced.

    Raises:
        CaseError: h is not a finite number ≥ 0 for each pair, jumps at closure, or differs in its
            slopes from what `slopes` returns.
    """

    coefficient: Coefficient
    slopes: Slopes | None = None
    needs_solid_fraction: Literal[False] = False

    def __post_init__(self) -> None:
        rng = np.random.default_rng(0)
        closed = np.arange(SAMPLES) % 2 == 0
        gap = np.where(closed, 0.0, rng.uniform(0.0, LARGEST_GAP, SAMPLES))
        pressure = np.where(closed, rng.uniform(0.0, LARGEST_PRESSURE, SAMPLES), 0.0)
        hot, cold = rng.uniform(COLDEST, HOTTEST, (2, SAMPLES))
        h = self._evaluated(gap, pressure, hot, cold)
        self._check_closure(hot, cold)
        if self.slopes is not None:
            self._check_slopes(h, gap, pressure, hot, cold)

    def _evaluated(
        self,
        gap: FloatArray,
        pressure: FloatArray,
        hot: FloatArray,
        cold: FloatArray,
        time: float = 0.0,
    ) -> FloatArray:
        h = np.asarray(self.coefficient(gap, pressure, hot, cold, time), dtype=np.float64)
        if h.shape != gap.shape:
            shapes = f"{gap.shape}, not {h.shape}"
            raise CaseError(f"a law must return one number for each pair: {shapes}")
        bad = np.flatnonzero(~(np.isfinite(h) & (h >= 0.0)))
        if bad.size:
            k = bad[0]
            raise CaseError(
                f"a heat-transfer coefficient must be finite and not negative; the law gives "
                f"{h[k]:g} W/m²/K at {_place(gap[k], pressure[k], hot[k], cold[k])}"
            )
        return h

    def _check_closure(self, hot: FloatArray, cold: FloatArray) -> None:
        zero = np.zeros(SAMPLES)
        closed = self._evaluated(zero, zero, hot, cold)
        opened = self._evaluated(zero + 1e-12, zero, hot, cold)
        jump = np.abs(opened - closed) > CLOSURE_JUMP * np.maximum(closed, opened)
        if jump.any():
            k = np.flatnonzero(jump)[0]
            raise CaseError(
                f"the law jumps at closure, from {closed[k]:g} to {opened[k]:g} W/m²/K at "
                f"{_place(0.0, 0.0, hot[k], cold[k])}; heat and gap could not agree"
            )

    def _check_slopes(
        self,
        h: FloatArray,
        gap: FloatArray,
        pressure: FloatArray,
        hot: FloatArray,
        cold: FloatArray,
    ) -> None:
        assert self.slopes is not None
        given = self.slopes(gap, pressure, hot, cold, 0.0)
        for slope, name, step in zip(given, ("secondary", "primary"), _steps(), strict=True):
            above = (self._evaluated(gap, pressure, hot + step[0], cold + step[1]) - h) / DIFFERENCE
            below = (h - self._evaluated(gap, pressure, hot - step[0], cold - step[1])) / DIFFERENCE
            # At a bend either side will do.
            error = np.minimum(np.abs(slope - above), np.abs(slope - below))
            allowed = SLOPE_ERROR * (np.abs(slope) + h / 100.0) + 1e-9 * h / DIFFERENCE
            if (error > allowed).any():
                k = int(np.argmax(error - allowed))
                raise CaseError(
                    f"the slope over the {name} temperature is {np.asarray(slope)[k]:g} W/m²/K², "
                    f"but the law changes by {above[k]:g} per kelvin at "
                    f"{_place(gap[k], pressure[k], hot[k], cold[k])}"
                )

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        hot, cold = faces.secondary.value, faces.primary.value

        def h(dT_secondary: float = 0.0, dT_primary: float = 0.0) -> FloatArray:
            faced = hot + dT_secondary, cold + dT_primary
            return np.asarray(self.coefficient(state.gap, state.pressure, *faced, faces.time))

        slopes = np.zeros((VARIABLES, len(hot)))
        if self.slopes is not None:
            given = self.slopes(state.gap, state.pressure, hot, cold, faces.time)
            slopes[SECONDARY], slopes[PRIMARY] = given
        else:
            for number, (a, b) in zip((SECONDARY, PRIMARY), _steps(), strict=True):
                slopes[number] = (h(a, b) - h(-a, -b)) / (2.0 * DIFFERENCE)
        # What it gives during a run may be wrong where it was right when it was tried.
        value = self._evaluated(state.gap, state.pressure, hot, cold, faces.time)
        return Conductance(Dual(value, slopes), touching(state))


def _steps() -> tuple[tuple[float, float], tuple[float, float]]:
    """Return steps of both temperatures, for the derivative over the first and the second."""
    return (DIFFERENCE, 0.0), (0.0, DIFFERENCE)


def _place(gap: float, pressure: float, hot: float, cold: float) -> str:
    return f"gap {gap:g} m, pressure {pressure:g} Pa, {hot:g} and {cold:g} °C"
