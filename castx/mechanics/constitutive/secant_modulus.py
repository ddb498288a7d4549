"""Shear modulus of the cells with which the stabilisation τ is formed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Conditions


class _Held(NamedTuple):
    """Points by what they have held in the passes of a step, each of shape (points,).

    Attributes:
        bears: some solid.
        firm: solid beside mush.
    """

    bears: BoolArray
    firm: BoolArray

    def also(self, conditions: Conditions) -> _Held:
        """Return the points with those of another pass."""
        bears = self.bears | (conditions.shares.end > 0)
        firm = self.firm.copy()
        if conditions.mush is not None:
            firm[conditions.mush.layers.points] = True
        return _Held(bears, firm)


class SecantModulus:
    """Secant shear modulus of the cells, that of the solid wherever there is any.

    With a mean of solid and liquid τ is too large, and so it is by mush that flows beside solid:
    points that hold both are taken as elastic. By its secant modulus a shrinking alloy that yields,
    in triangles as thick as its mush, has a quarter of its pores too few. What holds solid in some
    pass of a step, or both, counts as such until the end of the step, or heat and mechanics would
    follow each other round a jump.

    Attributes:
        function: the modulus [Pa], constant in each cell.
        bearing: 1 in cells that hold solid, 0 in the others, likewise until the end of a step.

    Args:
        points: integration points of the body.
        cells: functions constant in each cell.
    """

    def __init__(self, points: IntegrationPoints, cells: fem.FunctionSpace) -> None:
        self._points = points
        self.function, self.bearing = fem.Function(cells), fem.Function(cells)
        none: BoolArray = np.zeros(points.count, dtype=bool)
        self._none = self._held = self._accepted = _Held(none, none)

    def use(self, conditions: Conditions, softening: FloatArray) -> None:
        """Set the modulus for a pass of a step.

        Args:
            conditions: coefficients of the law.
            softening: secant modulus over the elastic one, shape (points,).
        """
        self._held = self._held.also(conditions)
        values = np.where(self._held.firm, 1.0, softening) * conditions.shear_modulus
        if conditions.liquid_modulus is not None:
            values = np.where(self._held.bears, values, conditions.liquid_modulus)
        self.function.x.array[:] = self._points.cell_means(values)
        self.bearing.x.array[:] = self._points.cell_means(self._held.bears.astype(float)) > 0

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""
        self._accepted, self._held = self._held, self._none

    def rewind(self, conditions: Conditions, softening: FloatArray) -> None:
        """Return to the last accepted step, arguments as those of `use`."""
        self._held = self._accepted
        self.use(conditions, softening)
        self.forget()

    def forget(self) -> None:
        """Forget which points held solid in the passes of a step."""
        self._held = self._none
