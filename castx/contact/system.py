"""Contact as the equilibrium of the bodies asks for it: unknowns, forces of the pairs, friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.augmented import AugmentedMultipliers
from castx.contact.friction.method import Friction, PairMemory
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.penalty_stiffness import PenaltyStiffness
from castx.contact.unknowns import ContactUnknowns


class NormalContact(Protocol):
    """Forces of the pairs along their normals.

    Pair arrays hold the rows of all interfaces of this rank, row arrays its owned unknowns.

    Attributes:
        follows_set: whether the matrix depends on the closed pairs.
        is_linear: whether it depends on nothing else.
    """

    follows_set: bool
    is_linear: bool

    @property
    def unknowns(self) -> ContactUnknowns:
        """The unknowns of the method."""

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over the matrix A of the bodies."""

    def matrix(self, iterate: PairIterate) -> PETSc.Mat:
        """Return the derivative of the rows, before any unknown is constrained."""

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m]."""

    def trial_forces(self, iterate: PairIterate) -> FloatArray:
        """Return the forces of closed pairs and trial forces of open ones [N], compressive > 0."""

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Add the forces of closed pairs to rows, or constrain unknowns."""

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return values of closed pairs that constrain no unknown, (motions, rows), if any."""

    def destroy(self) -> None:
        """Destroy the PETSc objects."""


class ContactSystem:
    """Contact of all interfaces by one method.

    Attributes:
        normal: forces of the pairs along their normals.
        unknowns: the unknowns of the method.
        layout: their numbering.

    Args:
        normal: forces of the pairs along their normals.
        friction: of the rows that have any: none or one.
        multipliers: pressures that improve between iterations: none or one.
        penalty: stiffness of the pairs that follows the matrix of the bodies, if they have any.
    """

    def __init__(
        self,
        normal: NormalContact,
        friction: Sequence[Friction] = (),
        multipliers: Sequence[AugmentedMultipliers] = (),
        penalty: PenaltyStiffness | None = None,
    ) -> None:
        self.normal, self.unknowns = normal, normal.unknowns
        self.layout = normal.unknowns.layout
        self._friction, self._multipliers, self._penalty = friction, multipliers, penalty
        self._memories: list[PairMemory] = [*multipliers, *friction]
        self._held: BoolArray = np.zeros((), dtype=bool)

    @property
    def follows_set(self) -> bool:
        """Whether the matrix depends on the state of the pairs."""
        return self.normal.follows_set or bool(self._friction)

    @property
    def has_friction(self) -> bool:
        """Whether any pair has friction."""
        return bool(self._friction)

    @property
    def is_linear(self) -> bool:
        """Whether the matrix depends on nothing but the closed pairs."""
        return self.normal.is_linear and not self._friction

    def begin(self, A: PETSc.Mat) -> None:
        """Begin a solve that starts with the matrix A of the bodies; collective."""
        if self._penalty is not None:
            self._penalty.update(A)
        for memory in self._memories:
            memory.begin()
        self.normal.update_bodies(A)

    def hold(self, held: BoolArray) -> None:
        """Let pairs pull that liquid holds closed; they bear no friction.

        Args:
            held: shape (pairs,).
        """
        self._held = held
        for part in self._multipliers:
            part.may_pull = held

    def _rubbing(self, iterate: PairIterate) -> PairIterate:
        """Return the iterate as friction sees it: a liquid touches without any."""
        return replace(iterate, closed=iterate.closed & ~self._held)

    def matrix(self, iterate: PairIterate) -> PETSc.Mat:
        """Return the derivative of the rows, before any unknown is constrained."""
        matrix = self.normal.matrix(iterate)
        for friction in self._friction:
            matrix = friction.add_to(matrix)
        return matrix

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Let the pairs act on rows.

        Args:
            iterate: the present iterate.
            forces: trial forces [N].
            rows: changed in place.
        """
        self.normal.impose(iterate, forces, rows)
        for friction in self._friction:
            friction.impose(self._rubbing(iterate), forces, rows)

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return values of constraint rows that fix no unknown, shape (motions, rows), if any."""
        found = [self.normal.constraint_values(motions, closed)]
        rubbing = closed & ~self._held
        found += [part.constraint_values(motions, rubbing) for part in self._friction]
        values = [value for value in found if value is not None]
        return np.concatenate(values, axis=1) if values else None

    def state(self, closed: BoolArray) -> BoolArray:
        """Return the flags of closed and of sticking pairs, on which the matrix depends.

        Args:
            closed: the present set of closed pairs.
        """
        touching = closed if self.follows_set else closed[:0]
        return np.concatenate([touching, *(part.sticking() for part in self._friction)])

    def update_friction(
        self, iterate: PairIterate, forces: FloatArray, threshold: float, settled: bool
    ) -> bool:
        """Let closed pairs begin to slip or to stick.

        Args:
            iterate: the present iterate.
            forces: trial forces [N].
            threshold: force that is noise [N].
            settled: whether the rows nearly balance for the present state of the pairs.

        Returns:
            Whether any did, on any rank.
        """
        rubbing = self._rubbing(iterate)
        changed = [part.update(rubbing, forces, threshold, settled) for part in self._friction]
        return any(changed)

    def along_surface(self, iterate: PairIterate) -> FloatArray | None:
        """Return the friction on secondary nodes [N], (rows, dimension); None: there is none."""
        rubbing = self._rubbing(iterate)
        return next((part.vectors(rubbing) for part in self._friction), None)

    def improve_multipliers(
        self, forces: FloatArray, closed: BoolArray, balanced: bool, enough: float
    ) -> bool:
        """Improve multipliers that are no unknowns.

        Args:
            forces: trial forces [N].
            closed: the present set of closed pairs.
            balanced: whether the rows balance with the present multipliers.
            enough: change of the forces that is not worth another solution [N].

        Returns:
            Whether they changed, on any rank.
        """
        changed = [part.augment(forces, closed, balanced, enough) for part in self._multipliers]
        return any(changed)

    def commit(self, x: PETSc.Vec) -> None:
        """Accept the state at the unknowns x as the start of the next step."""
        for memory in self._memories:
            memory.commit(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the accepted state, whose unknowns are x."""
        for memory in self._memories:
            memory.rewind(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return accepted numbers of the pairs that are no unknowns, each of shape (rows,)."""
        return {name: array for memory in self._memories for name, array in memory.saved().items()}

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Restore accepted numbers of the pairs."""
        for memory in self._memories:
            memory.restore(arrays)

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for memory in self._memories:
            memory.destroy()
        self.normal.destroy()
