"""History of the integration points, from the end of one step to the start of the next.

It is the history of the solid there. What is born dilutes it, since new solid has no past (`growth`
says how); with the last solid it melts away.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.stateful import Arrays, Saved


class PointHistory(NamedTuple):
    """State of the points at the end of a step.

    Attributes:
        elastic: elastic strain E of the solid, shape (points, components).
        plastic: viscoplastic strain of the solid, shape (points, components).
        equivalent: its equivalent ξ, the integral of its rate, shape (points,).
        strain: deviatoric strain at the end of the last step, shape (points, components).
        softening: secant shear modulus over the elastic one, shape (points,).
        shape: sum of all de^c, the deviatoric part of contraction, shape (points, components).
    """

    elastic: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    strain: FloatArray
    softening: FloatArray
    shape: FloatArray

    def saved(self, points: IntegrationPoints) -> dict[str, Saved]:
        """Return the arrays for a checkpoint, by cell."""
        return {
            name: Saved(points.by_cell(values), points.numbering)
            for name, values in self._asdict().items()
        }

    def restored(self, arrays: Arrays) -> PointHistory:
        """Return the history that arrays of `saved` hold, in the shapes of this one."""
        return PointHistory(
            *(arrays[name].reshape(own.shape) for name, own in self._asdict().items())
        )

    @classmethod
    def initial(cls, points: IntegrationPoints) -> PointHistory:
        """Return the history of an unstrained body."""
        none = np.zeros((points.count, points.components))
        return cls(none, none, np.zeros(points.count), none, np.ones(points.count), none)
