"""Different laws on parts of one interface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.transfer.conductance import VARIABLES, Conductance, ConductionLaw, Faces
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState, Points


@dataclass(frozen=True)
class PatchedLaw:
    """Different laws on parts of an interface.

    Attributes:
        patches: pairs of each part, and its law; every pair is in one.
    """

    patches: Sequence[tuple[Points, ConductionLaw]]

    @property
    def needs_solid_fraction(self) -> bool:
        """Whether one of the laws does."""
        return any(law.needs_solid_fraction for _, law in self.patches)

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        h = Dual.constant(np.zeros(len(state.gap)), VARIABLES)
        contact = np.zeros(len(state.gap))
        for points, law in self.patches:
            part = law(state.at(points), faces.at(points))
            h.value[points] = part.coefficient.value
            h.slopes[:, points] = part.coefficient.slopes
            contact[points] = part.contact
        return Conductance(h, contact)
