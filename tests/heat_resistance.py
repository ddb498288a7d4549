"""Node pairs of given thermal resistances."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.transfer.conductance import VARIABLES, Conductance, Faces, touching
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState


class LayerOfUnitConductivity:
    """h = 1/g: the resistance of a pair in m² K/W is its gap in m."""

    needs_solid_fraction = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs, all of it through the layer."""
        h = Dual.constant(1.0 / state.gap, VARIABLES)
        return Conductance(h, touching(state))


LAYER = LayerOfUnitConductivity()


def of_resistance(resistance: FloatArray) -> PairState:
    """Return the pairs that have a resistance [m² K/W] under `LAYER`."""
    return PairState.of(resistance, np.zeros(len(resistance)))
