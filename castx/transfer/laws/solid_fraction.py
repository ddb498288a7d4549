"""Gap heat law `solid-fraction`: how much of the casting is solid stands for the gap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from castx.transfer.coefficients import Coefficient, Varied, closed_coefficient
from castx.transfer.conductance import Conductance, Faces
from castx.transfer.declaration import GapHeatLaw, Given
from castx.transfer.keys import CLOSED, GAS_CONDUCTIVITY, OPEN, RADIATION, ROUGH
from castx.transfer.pair_state import PairState


@dataclass(frozen=True)
class SolidFractionTransfer:
    """Mean of two coefficients, h = F_S·open + (1 − F_S)·closed, F_S that of the secondary body.

    F_S = (1/V) ∫ f_s dV. For runs without mechanics: the volume that has shrunk stands for the gap.
    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2.

    Attributes:
        closed: coefficient at the start [W/m²/K].
        open: coefficient of the mean gap at the end [W/m²/K].
        needs_solid_fraction: always.
    """

    closed: Coefficient
    open: Coefficient
    needs_solid_fraction: Literal[True] = True

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs; the part of `open` counts as heat through the gas."""
        solid = faces.solid_fraction
        contact = (-solid + 1.0) * self.closed(state, faces)
        h = contact + solid * self.open(state, faces)
        return Conductance(h, contact.value / h.value)


def build(given: Given) -> SolidFractionTransfer:
    """Return the law of an interface."""
    return SolidFractionTransfer(closed_coefficient(given), Varied(given.need(OPEN)))


LAW = GapHeatLaw(
    name="solid-fraction",
    summary="From the closed to the open coefficient as the whole casting freezes; for runs "
    "without mechanics.",
    formula="h = F_S·open + (1 − F_S)·closed",
    source="M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2",
    build=build,
    needed=(CLOSED.varying_over("temperature", "time"), OPEN.varying_over("temperature", "time")),
    useful=(GAS_CONDUCTIVITY, *ROUGH, RADIATION),
    needs_solid_fraction=True,
)
