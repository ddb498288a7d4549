"""The piecewise constant pressure of Q1/P0 (Nagtegaal, Parks and Rice 1974; Hughes 1980).

The pressure of a cell is not an unknown: p = (mean(∇·u) - e^θ)/c with c = 1/K. Where c is zero or
small it becomes a multiplier, found together with the displacement (Fortin and Glowinski 1983):

    p = [mean(∇·u) - e^θ + (ĉ - c) p_k] / ĉ,   ĉ = max(c, a small number),   p_k ← p.
"""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix

from castx.arrays import FloatArray
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics, momentum
from castx.mechanics.constitutive.law import Conditions
from castx.stateful import Arrays, Saved

SMALLEST_COMPRESSIBILITY = 1e-3
"""ĉ of an incompressible cell in units of 1/G: the error of p falls so fast in each iteration."""


class MeanDilatation:
    """Pressures of the cells of one body and their forces.

    Args:
        body: mesh of the body.
        cells: functions constant in each cell.
        space: displacements (and the axial strain) of the body.
        strain: ε of the trial functions of `space`.
        dx: weighted measure of the points.
        shear_modulus: largest shear modulus of the body [Pa].
    """

    def __init__(
        self,
        body: BodyMesh,
        cells: fem.FunctionSpace,
        space: fem.FunctionSpace,
        strain: Any,
        dx: kinematics.WeightedMeasure,
        shear_modulus: float,
    ) -> None:
        self._numbering = body.cell_numbering
        self._matrix = assemble_matrix(
            fem.form(momentum.dilatation(strain, ufl.TestFunction(cells), dx))
        )
        self._matrix.assemble()
        self._smallest = SMALLEST_COMPRESSIBILITY / shear_modulus
        self._owned = cells.dofmap.index_map.size_local
        self._volumes = fem.assemble_vector(
            fem.form(ufl.TestFunction(cells) * dx)
        ).array[: self._owned].copy()
        count = self._owned + cells.dofmap.index_map.num_ghosts
        self._multiplier = np.zeros(count)
        self._committed = np.zeros(count)
        self._compressibility = np.ones(count)
        self._free = np.zeros(count)
        self._given: FloatArray | None = None
        self.pressure: FloatArray = np.zeros(count)
        self._cell_values = self._matrix.createVecLeft()
        self._forces = self._matrix.createVecRight()

    def begin(self, conditions: Conditions, given: FloatArray | None = None) -> None:
        """Set the conditions of a trial step.

        Args:
            conditions: of the step.
            given: pressures of trapped liquid [Pa], nan elsewhere, shape (cells,).
        """
        self._compressibility, self._free = conditions.compressibility, conditions.thermal_strain
        self._given = given

    def update(self, dilatation: FloatArray) -> None:
        """Find the pressures for volumetric strains of the cells, shape (cells,)."""
        c, least = self._compressibility, self._least()
        self.pressure = (dilatation - self._free + (least - c) * self._multiplier) / least
        if self._given is not None:
            self.pressure = np.where(np.isnan(self._given), self.pressure, self._given)

    def _least(self) -> FloatArray:
        return np.maximum(self._compressibility, self._smallest)

    def improve(self) -> None:
        """Take the present pressures for the multipliers."""
        self._multiplier = self.pressure.copy()

    @property
    def iterates(self) -> bool:
        """Whether any cell of this rank is so little compressible that it has a multiplier."""
        return bool((self._compressibility < self._smallest).any())

    def forces(self) -> FloatArray:
        """Return ∫ p ∇·η of the owned unknowns [N]."""
        self._cell_values.array[:] = self.pressure[: self._owned]
        self._matrix.multTranspose(self._cell_values, self._forces)
        return np.asarray(self._forces.array_r)

    def add_tangent(self, A: PETSc.Mat) -> None:
        """Add the derivative of `forces` to a matrix that has its entries."""
        scaled = self._matrix.copy()
        free = np.ones(self._owned) if self._given is None else np.isnan(self._given[: self._owned])
        self._cell_values.array[:] = free / (self._volumes * self._least()[: self._owned])
        scaled.diagonalScale(self._cell_values, None)
        product = self._matrix.transposeMatMult(scaled)
        A.axpy(1.0, product, structure=PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        for item in (scaled, product):
            item.destroy()

    def commit(self) -> None:
        """Make the present pressures the multipliers with which the next step starts."""
        self._multiplier = self.pressure.copy()
        self._committed = self._multiplier

    def rewind(self) -> None:
        """Return to the multipliers of the last accepted step."""
        self._multiplier = self._committed

    def saved(self) -> dict[str, Saved]:
        """Return the multipliers of the last accepted step."""
        return {"multiplier": Saved(self._committed.copy(), self._numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Take back the multipliers of the last accepted step."""
        self._committed = arrays["multiplier"].copy()
        self.pressure = self._committed.copy()
        self.rewind()

    def destroy(self) -> None:
        """Free what PETSc holds."""
        for item in (self._matrix, self._cell_values, self._forces):
            item.destroy()
