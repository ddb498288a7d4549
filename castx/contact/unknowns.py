"""The unknowns x of a contact method and the rows of the bodies in them."""

from __future__ import annotations

from typing import Protocol

from petsc4py import PETSc

from castx.arrays import FloatArray
from castx.contact.kinematics.transform import ConstraintTransform
from castx.solvers.layout import Layout


class ContactUnknowns(Protocol):
    """The unknowns x of a contact method; the first ones on each rank are v, see `transform`.

    Attributes:
        layout: numbering of the unknowns.
    """

    layout: Layout

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures u of all bodies from the unknowns."""

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows before the pairs act, from the residual r of the bodies."""

    def extended(self, v: FloatArray) -> FloatArray:
        """Return owned unknowns v of the bodies with zeros for all others, last axis owned."""


class TransformedUnknowns:
    """The unknowns v of the bodies alone: u = P v, rows Pᵀr.

    Args:
        transform: change of unknowns of all bodies.
    """

    def __init__(self, transform: ConstraintTransform) -> None:
        self.layout: Layout = transform.layout
        self._P = transform.P
        self._rows = self.layout.create_vector()

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set u = P v."""
        self._P.mult(x, u)

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows of Pᵀr."""
        self._P.multTranspose(r, self._rows)
        rows: FloatArray = self._rows.array_r.copy()
        return rows

    def extended(self, v: FloatArray) -> FloatArray:
        """Return v: there are no other unknowns."""
        return v

    def destroy(self) -> None:
        """Free the vector."""
        self._rows.destroy()
