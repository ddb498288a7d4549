"""Condensed contact: the gap of every pair is one of the unknowns (no penalty, no multiplier).

With u = P v the matrix is PᵀAP and the residual Pᵀr; a closed pair is the Dirichlet condition
v_k = -g0 and its contact force p_c S the residual of that row.
"""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.contact.gaps import Gaps
from castx.coordinates import Coordinates
from castx.layout import Layout

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


class CondensedContact:
    """The unknowns v, in which gaps are coordinates.

    Args:
        coordinates: condensed coordinates of all bodies.
        gaps: the pairs of all interfaces.
    """

    def __init__(self, coordinates: Coordinates, gaps: Gaps) -> None:
        self.layout: Layout = coordinates.layout
        self._P = coordinates.to_displacements
        self._gaps = gaps
        self._residual = self.layout.create_vector()
        self._matrix: PETSc.Mat | None = None

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures of all bodies from the unknowns."""
        self._P.mult(x, u)

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows of the residual without contact from r, that of the bodies."""
        self._P.multTranspose(r, self._residual)
        return self._residual.array_r.copy()

    def matrix(self, A: PETSc.Mat) -> PETSc.Mat:
        """Return PᵀAP; the next call overwrites it."""
        if self._matrix is None:
            self._matrix = A.ptap(self._P)
        else:
            A.ptap(self._P, self._matrix)
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m]; exact zero where a pair is closed."""
        gaps = self._gaps.values(u)
        free = self._gaps.free
        gaps[free] = x.array_r[self._gaps.local[free]] + self._gaps.initial[free]
        return gaps

    def forces(self, x: PETSc.Vec, residual: FloatArray) -> FloatArray:
        """Return the forces that closed pairs carry [N], from the rows of `residual`."""
        forces = np.zeros(len(self._gaps.free))
        free = self._gaps.free
        forces[free] = residual[self._gaps.local[free]]
        return forces

    def hold(
        self, x: PETSc.Vec, closed: BoolArray, held: BoolArray, violation: FloatArray
    ) -> None:
        """Mark the unknowns that closed pairs hold, with their distance from their place [m]."""
        local = self._gaps.local[closed]
        held[local] = True
        violation[local] = x.array_r[local] + self._gaps.initial[closed]

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> None:
        """Return further constraint rows: none, since closed pairs hold unknowns."""
        return None

    def to_unknowns(self, coordinates: FloatArray) -> FloatArray:
        """Return the coordinates: they are the unknowns."""
        return coordinates

    def destroy(self) -> None:
        """Free the matrix and vectors."""
        for item in (self._matrix, self._residual):
            if item is not None:
                item.destroy()
