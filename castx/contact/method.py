"""What every contact method offers to the equilibrium of the bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from petsc4py import PETSc

from castx.arrays import BoolArray, FloatArray
from castx.solvers.layout import Layout


class ContactSystem(Protocol):
    """The unknowns x of a contact method and its rows of the nonlinear problem.

    Pair arrays hold the rows of all interfaces of this rank, row arrays its owned unknowns. The
    first unknowns on each rank are the coordinates v of the bodies.

    Attributes:
        layout: numbering of the unknowns.
        follows_set: whether the matrix depends on the state of the pairs.
        follows_motion: whether it depends on how they move.
    """

    layout: Layout
    follows_set: bool
    follows_motion: bool

    def prepare(self, A: PETSc.Mat) -> None:
        """Begin a solve that starts with the matrix A of the bodies; collective."""

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures of all bodies from the unknowns."""

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows before the pairs act, from the residual r of the bodies."""

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over the matrix A of the bodies."""

    def matrix(self, closed: BoolArray) -> PETSc.Mat:
        """Return the derivative of the rows for a set of closed pairs, before any is held."""

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps [m]."""

    def trial_forces(
        self, x: PETSc.Vec, rows: FloatArray, gaps: FloatArray, closed: BoolArray, stiffness: float
    ) -> FloatArray:
        """Return the forces that closed pairs carry and open ones would [N], compressive positive.

        Args:
            x: the unknowns.
            rows: what `residual` returned for them.
            gaps: their gaps [m].
            closed: the present set.
            stiffness: force per penetration of pairs that carry none while open [N/m].
        """

    def impose(
        self,
        x: PETSc.Vec,
        forces: FloatArray,
        closed: BoolArray,
        rows: FloatArray,
        held: BoolArray,
        violation: FloatArray,
    ) -> None:
        """Let the pairs act: add forces to rows, or mark what they hold and how far off it is."""

    def augment(
        self, forces: FloatArray, closed: BoolArray, balanced: bool, enough: float
    ) -> bool:
        """Improve multipliers that are no unknowns; return whether they changed, on any rank.

        Args:
            forces: trial forces.
            closed: the present set.
            balanced: whether the rows balance with the present multipliers.
            enough: change of the forces that is not worth another solution [N].
        """

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return the values of constraint rows that hold no unknown, shape (motions, rows)."""

    def to_unknowns(self, coordinates: FloatArray) -> FloatArray:
        """Return owned rows that hold coordinates v of the bodies and zeros, last axis owned."""

    def state(self, closed: BoolArray) -> BoolArray:
        """Return what the matrix depends on besides the bodies: pairs that close, stick, slip."""

    def slide(
        self, x: PETSc.Vec, rows: FloatArray, forces: FloatArray, closed: BoolArray,
        stiffness: float, threshold: float, settled: bool,
    ) -> bool:  # fmt: skip
        """Let closed pairs begin to slip or to stick; return whether any did, on any rank.

        Args:
            x: the unknowns.
            rows: what `residual` returned for them.
            forces: trial forces.
            closed: the present set.
            stiffness: force per motion against friction that counts as much [N/m].
            threshold: force that is noise [N].
            settled: whether the rows nearly balance for the present state of the pairs.
        """

    def along_surface(self, x: PETSc.Vec, rows: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return the friction on secondary nodes [N], (rows, dimension); None: there is none."""

    def commit(self, x: PETSc.Vec) -> None:
        """Make what is present at unknowns x that from which the next step starts."""

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to what was committed at unknowns x."""

    def saved(self) -> dict[str, FloatArray]:
        """Return committed numbers of the pairs that are no unknowns, each of shape (rows,)."""

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back committed numbers of the pairs."""

    def destroy(self) -> None:
        """Free what PETSc holds."""
