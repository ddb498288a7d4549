"""History of the integration points, from the end of one step to the start of the next.

A solid is born without stress from before the step in which it freezes: its strain counts from the
strain at the start of this step. Melting erases the history.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.stateful import Arrays, Saved


class PointHistory(NamedTuple):
    """State of the points at the end of a step.

    Attributes:
        birth: deviatoric strain at which the solid froze, shape (points, components).
        plastic: viscoplastic strain since then, shape (points, components).
        equivalent: its equivalent ξ, the integral of its rate, shape (points,).
        strain: deviatoric strain at the end of the last step, shape (points, components).
        softening: secant shear modulus over the elastic one, shape (points,).
        coherent: whether the cell was a solid, shape (cells,).
    """

    birth: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    strain: FloatArray
    softening: FloatArray
    coherent: BoolArray

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
    def initial(cls, points: IntegrationPoints, liquid: bool) -> PointHistory:
        """Return the history of an unstrained body, all of it liquid or all of it solid."""
        none = np.zeros((points.count, points.components))
        return cls(
            none, none, np.zeros(points.count), none, np.ones(points.count),
            np.full(points.cells, not liquid),
        )  # fmt: skip

    def start(self, coherent: BoolArray, points: IntegrationPoints) -> PointHistory:
        """Return the history at the start of a step, reset where a cell melts or freezes in it.

        A cell that is liquid at the start or at the end of the step keeps its strain alone.

        Args:
            coherent: whether a cell is solid at the end of the step, shape (cells,).
            points: integration points of the body.
        """
        new = points.from_cells(~(coherent & self.coherent))
        if not new.any():
            return self
        born = points.from_cells(coherent & ~self.coherent)
        return self._replace(
            birth=np.where(new[:, None], self.strain, self.birth),
            plastic=np.where(new[:, None], 0.0, self.plastic),
            equivalent=np.where(new, 0.0, self.equivalent),
            softening=np.where(born, 1.0, self.softening),
        )
