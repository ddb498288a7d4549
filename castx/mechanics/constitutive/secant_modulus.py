"""Shear modulus of the cells with which the stabilisation τ is formed."""

from __future__ import annotations

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Conditions


class SecantModulus:
    """Secant shear modulus of the cells, that of the solid wherever there is any.

    With a mean of solid and liquid τ is too large, and so it is by what has flowed there: liquid, or
    mush, a layer beside solid that does not flow. Where a step begins with less than all of it the
    solid is taken as elastic. By its secant modulus a shrinking alloy that yields, in
    triangles as thick as the mush, has a quarter of its pores too few. A point
    that holds solid in some pass of a step keeps its modulus until the end of the step, or heat and
    mechanics would follow each other round a jump.

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
        self._none: BoolArray = np.zeros(points.count, dtype=bool)
        self._bears: BoolArray = self._none
        self._accepted: BoolArray = self._none

    def use(self, conditions: Conditions, softening: FloatArray) -> None:
        """Set the modulus for a pass of a step.

        Args:
            conditions: coefficients of the law.
            softening: secant modulus over the elastic one, shape (points,).
        """
        self._bears = self._bears | (conditions.shares.end > 0)
        mixed = self._bears & (conditions.shares.start < 1)
        values = np.where(mixed, 1.0, softening) * conditions.shear_modulus
        if conditions.liquid_modulus is not None:
            values = np.where(self._bears, values, conditions.liquid_modulus)
        self.function.x.array[:] = self._points.cell_means(values)
        self.bearing.x.array[:] = self._points.cell_means(self._bears.astype(float)) > 0

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""
        self._accepted, self._bears = self._bears, self._none

    def rewind(self, conditions: Conditions, softening: FloatArray) -> None:
        """Return to the last accepted step, arguments as those of `use`."""
        self._bears = self._accepted
        self.use(conditions, softening)
        self.forget()

    def forget(self) -> None:
        """Forget which points held solid in the passes of a step."""
        self._bears = self._none
