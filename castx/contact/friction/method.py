"""Protocol of friction in the equilibrium, and the state of pairs from step to step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from petsc4py import PETSc

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate


class PairMemory(Protocol):
    """Numbers of the pairs that are no unknowns and last from step to step."""

    def begin(self) -> None:
        """Begin a solve."""

    def commit(self, x: PETSc.Vec) -> None:
        """Accept the state at the unknowns x as the start of the next step."""

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the accepted state, whose unknowns are x."""

    def saved(self) -> dict[str, FloatArray]:
        """Return the accepted numbers by name, each of shape (rows,)."""

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Restore accepted numbers of all rows."""

    def destroy(self) -> None:
        """Destroy the PETSc objects."""


class Friction(PairMemory, Protocol):
    """Forces along the surface of closed pairs, which stick or slip."""

    def sticking(self) -> BoolArray:
        """Return a mask of the sticking rows, on which the matrix depends."""

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Add the friction at an iterate to rows, or constrain the motions that stick.

        Args:
            iterate: the present iterate.
            forces: normal forces of all rows [N].
            rows: changed in place.
        """

    def update(
        self, iterate: PairIterate, forces: FloatArray, threshold: float, settled: bool
    ) -> bool:
        """Let pairs slip or stick that violate their state; return whether any did, on any rank.

        Args:
            iterate: the present iterate.
            forces: normal forces of all rows [N].
            threshold: force that is noise [N].
            settled: whether pairs that stick may begin to slip.
        """

    def add_to(self, matrix: PETSc.Mat) -> PETSc.Mat:
        """Return the matrix of all rows with friction as last imposed; may reuse the given one."""

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return values of rows that stick without constraining unknowns, (motions, rows)."""

    def vectors(self, iterate: PairIterate) -> FloatArray:
        """Return the friction on the secondary nodes of all rows [N], shape (rows, dimension)."""
