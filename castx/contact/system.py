"""What every contact method offers to the equilibrium of the bodies."""

from __future__ import annotations

from typing import Protocol

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.layout import Layout

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


class ContactSystem(Protocol):
    """The unknowns x of a contact method and its rows of the nonlinear problem.

    Pair arrays hold the pairs of all interfaces of this rank, row arrays its owned unknowns. The
    first unknowns on each rank are the coordinates v of the bodies.
    """

    layout: Layout

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures of all bodies from the unknowns."""

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows before any unknown is held, from the residual r of the bodies."""

    def matrix(self, A: PETSc.Mat) -> PETSc.Mat:
        """Return the derivative of `residual` for the matrix A of the bodies."""

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps [m]."""

    def forces(self, x: PETSc.Vec, residual: FloatArray) -> FloatArray:
        """Return the forces that closed pairs carry [N], positive compressive."""

    def hold(
        self, x: PETSc.Vec, closed: BoolArray, held: BoolArray, violation: FloatArray
    ) -> None:
        """Mark the unknowns that the state of the pairs holds, and how far off they are."""

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return the values of constraint rows that hold no unknown, shape (motions, rows)."""

    def to_unknowns(self, coordinates: FloatArray) -> FloatArray:
        """Return owned rows that hold coordinates v of the bodies and zeros, last axis owned."""

    def destroy(self) -> None:
        """Free what PETSc holds."""
