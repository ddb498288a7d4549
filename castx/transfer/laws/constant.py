"""Gap heat law `constant`: one coefficient for closed and open pairs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from castx.input.problems import Problem
from castx.transfer.coefficients import (
    Coefficient,
    PressureTerm,
    closed_coefficient,
    pressure_term,
    under_pressure,
)
from castx.transfer.conductance import Conductance, Faces
from castx.transfer.declaration import GapHeatLaw, Given
from castx.transfer.keys import CLOSED, GAS_CONDUCTIVITY, PRESSURE, RADIATION, ROUGH, ROUGHNESS
from castx.transfer.pair_state import PairState


@dataclass(frozen=True)
class ConstantLaw:
    """One coefficient whatever the gap, h = closed + h(p).

    Attributes:
        closed: coefficient without pressure [W/m²/K].
        pressure: what contact pressure adds.
        needs_solid_fraction: never.
    """

    closed: Coefficient
    pressure: PressureTerm | None = None
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        return under_pressure(self.closed(state, faces), self.pressure, state, faces)


def build(given: Given) -> ConstantLaw:
    """Return the law of an interface."""
    return ConstantLaw(closed_coefficient(given), pressure_term(given))


def problems(given: Given) -> Iterator[Problem]:
    """Yield a conductivity of the gas that nothing uses."""
    pressure = given.get(PRESSURE)
    rough = given.has(ROUGHNESS) or (pressure is not None and pressure.roughness is not None)
    if given.has(GAS_CONDUCTIVITY) and not rough:
        yield Problem(("gas_conductivity",), "the law 'constant' needs it for roughness only")


LAW = GapHeatLaw(
    name="constant",
    summary="One coefficient, whatever the gap.",
    formula="h = closed + (1/R)(p/H_e)^b",
    source="M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.1, with a floor",
    build=build,
    needed=(CLOSED,),
    useful=(PRESSURE, GAS_CONDUCTIVITY, *ROUGH, RADIATION),
    problems=problems,
)
