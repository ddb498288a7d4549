"""Penalty contact (Chiumenti, sections 7.1 and 7.2): a closed pair carries p_c = λ + ε⟨-g⟩.

λ is zero in the penalty method and a given pressure in the augmented Lagrangian one, which improves
it between iterations. In the unknowns of the bodies the rows are Pᵀr - Gᵀf with G = ∂g/∂v and
f = p_c S, the matrix PᵀAP + Gᵀ diag(ε S) G over the closed pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.penalty import PenaltyFriction
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.solvers.layout import Layout


class Multipliers(Protocol):
    """Contact pressures that the penalty adds to.

    Attributes:
        pressures: λ [Pa], shape (rows,).
    """

    pressures: FloatArray

    def begin(self) -> None:
        """Start a new solve."""

    def augment(self, pressures: FloatArray, balanced: bool) -> bool:
        """Take over better pressures [Pa]; return whether they changed, on any rank."""

    def commit(self) -> None:
        """Make the present pressures those from which the next step starts."""

    def rewind(self) -> None:
        """Return to the committed pressures."""

    def saved(self) -> dict[str, FloatArray]:
        """Return what the pairs remember."""

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back what the pairs remember."""


class NoMultipliers:
    """The penalty alone.

    Args:
        rows: number of rows of all interfaces.
    """

    def __init__(self, rows: int) -> None:
        self.pressures: FloatArray = np.zeros(rows)

    def begin(self) -> None:
        """Do nothing."""

    def augment(self, pressures: FloatArray, balanced: bool) -> bool:
        """Return that nothing changed."""
        return False

    def commit(self) -> None:
        """Do nothing."""

    def rewind(self) -> None:
        """Do nothing."""

    def saved(self) -> dict[str, FloatArray]:
        """Return nothing."""
        return {}

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Do nothing."""


class PenaltyContact:
    """The unknowns are the coordinates v of the bodies, in which gaps are no coordinates.

    Args:
        coordinates: coordinates of all bodies.
        gaps: the pairs of all interfaces.
        penalty: returns ε [Pa/m] of all rows for a matrix of the bodies; collective.
        multipliers: what the penalty adds to.
        friction: of the pairs that have any.
    """

    follows_set = True

    def __init__(
        self,
        coordinates: Coordinates,
        gaps: Gaps,
        penalty: Callable[[PETSc.Mat], FloatArray],
        multipliers: Multipliers,
        friction: PenaltyFriction | None = None,
    ) -> None:
        self.layout: Layout = coordinates.layout
        self._friction, self.follows_motion = friction, friction is not None
        self._P, self._gaps = coordinates.to_displacements, gaps
        self._penalty, self.multipliers = penalty, multipliers
        self._G = gaps.matrix.matMult(self._P)
        self._Gt = self._G.copy().transpose()
        self._pairs = self._G.createVecLeft()
        self._work = self.layout.create_vector()
        self._springs: FloatArray = np.zeros(len(gaps.free))
        self._bodies: PETSc.Mat | None = None
        self._scaled: PETSc.Mat | None = None
        self._contact: PETSc.Mat | None = None
        self._matrix: PETSc.Mat | None = None

    def prepare(self, A: PETSc.Mat) -> None:
        """Evaluate the penalty for the present matrix of the bodies."""
        penalty = self._penalty(A)
        self._springs = np.where(self._gaps.free, penalty * self._gaps.areas, 0.0)
        self.multipliers.begin()
        if self._friction is not None:
            self._friction.begin()

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures of all bodies from the unknowns."""
        self._P.mult(x, u)

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows of the residual without contact from r, that of the bodies."""
        self._P.multTranspose(r, self._work)
        return self._work.array_r.copy()

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over A as PᵀAP."""
        if self._bodies is None:
            self._bodies = A.ptap(self._P)
        else:
            A.ptap(self._P, self._bodies)

    def matrix(self, closed: BoolArray) -> PETSc.Mat:
        """Return PᵀAP + Gᵀ diag(ε S) G over the closed pairs; the next call overwrites it."""
        assert self._bodies is not None
        self._pairs.array[:] = np.where(closed, self._springs, 0.0)
        if self._scaled is None:
            self._scaled = self._G.copy()
        else:
            self._G.copy(self._scaled)
        self._scaled.diagonalScale(self._pairs, None)
        structure = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
        if self._contact is None or self._matrix is None:
            self._contact = self._Gt.matMult(self._scaled)
            self._matrix = self._bodies.copy()
            self._matrix.axpy(1.0, self._contact)
        else:
            self._Gt.matMult(self._scaled, self._contact)
            self._matrix.zeroEntries()
            self._matrix.axpy(1.0, self._bodies, structure)
            self._matrix.axpy(1.0, self._contact, structure)
        if self._friction is not None:
            self._matrix.axpy(1.0, self._friction.matrix(self._G))
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m], negative where they penetrate."""
        return self._gaps.values(u)

    def trial_forces(
        self, x: PETSc.Vec, rows: FloatArray, gaps: FloatArray, closed: BoolArray, stiffness: float
    ) -> FloatArray:
        """Return (λ - ε g) S, closed or not."""
        carried = np.where(self._gaps.free, self.multipliers.pressures * self._gaps.areas, 0.0)
        return np.asarray(carried - self._springs * gaps)

    def impose(
        self,
        x: PETSc.Vec,
        forces: FloatArray,
        closed: BoolArray,
        rows: FloatArray,
        held: BoolArray,
        violation: FloatArray,
    ) -> None:
        """Let the closed pairs push their nodes."""
        self._pairs.array[:] = np.where(closed, forces, 0.0)
        self._Gt.mult(self._pairs, self._work)
        rows -= self._work.array_r
        if self._friction is not None:
            self._friction.impose(x, forces, closed, self._springs, rows)

    def augment(
        self, forces: FloatArray, closed: BoolArray, balanced: bool, enough: float
    ) -> bool:
        """Let the multipliers take over the present pressures; return whether any changed."""
        areas = self._gaps.areas
        pressures = np.divide(forces, areas, out=np.zeros_like(forces), where=areas > 0)
        pressures[~closed] = 0.0
        self._pairs.array[:] = areas * (pressures - self.multipliers.pressures)
        if balanced and self._pairs.norm() <= enough:
            return False
        return self.multipliers.augment(pressures, balanced)

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return what closed pairs hold of motions: gaps, and what sticks; (motions, rows)."""
        values = np.zeros((len(motions), int(np.count_nonzero(closed))))
        for row, motion in enumerate(motions):
            self._work.array[:] = motion
            self._G.mult(self._work, self._pairs)
            values[row] = self._pairs.array_r[closed]
        if self._friction is None:
            return values
        return np.concatenate((values, self._friction.held_motions(motions, closed)), axis=1)

    def to_unknowns(self, coordinates: FloatArray) -> FloatArray:
        """Return the coordinates: they are the unknowns."""
        return coordinates

    def state(self, closed: BoolArray) -> BoolArray:
        """Return which pairs close and slip."""
        slips = [] if self._friction is None else [self._friction.state()]
        return np.concatenate([closed, *slips])

    def slide(
        self, x: PETSc.Vec, rows: FloatArray, forces: FloatArray, closed: BoolArray,
        stiffness: float, threshold: float, settled: bool,
    ) -> bool:  # fmt: skip
        """Let closed pairs begin to slip or to stick; return whether any did, on any rank."""
        return self._friction is not None and self._friction.update(closed, threshold, settled)

    def along_surface(self, x: PETSc.Vec, rows: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return the friction on secondary nodes [N], (rows, dimension); None: there is none."""
        return None if self._friction is None else self._friction.vectors()

    def commit(self, x: PETSc.Vec) -> None:
        """Make the present multipliers and friction those from which the next step starts."""
        self.multipliers.commit()
        if self._friction is not None:
            self._friction.commit(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the committed multipliers and friction."""
        self.multipliers.rewind()
        if self._friction is not None:
            self._friction.rewind(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return the committed multipliers and friction, if the method has any."""
        return self.multipliers.saved() | ({} if self._friction is None else self._friction.saved())

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back committed multipliers and friction."""
        self.multipliers.restore(arrays)
        if self._friction is not None:
            self._friction.restore(arrays)

    def destroy(self) -> None:
        """Free matrices and vectors."""
        if self._friction is not None:
            self._friction.destroy()
        for item in (self._matrix, self._contact, self._scaled, self._bodies, self._G, self._Gt):
            if item is not None:
                item.destroy()
        self._pairs.destroy()
        self._work.destroy()
