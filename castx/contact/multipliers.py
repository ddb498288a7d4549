"""Contact by Lagrange multipliers (Chiumenti, section 8), the three-block arrow-shaped system.

    [ A   Bᵀ ] [ v ]
    [ B   0  ] [ λ ]

with B = -S ∂g/∂u, λ = p_c ≥ 0 and, for a closed pair, B u = S g0; an open pair has λ = 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.solvers.layout import Layout

AUGMENTATION = 50.0
"""Penalty of the augmented block of the bodies, in units of G/L."""


class _Part(NamedTuple):
    """The number of nodes of one part of a layout on this rank."""

    size_local: int


class MultiplierContact:
    """The unknowns are the coordinates v of the bodies, then a scaled pressure for each pair.

    Args:
        coordinates: coordinates of all bodies that do not condense the gaps.
        gaps: the pairs of all interfaces.
        stiffness: pressure per length that makes lengths of the multipliers [Pa/m], so that all
            rows are forces.
    """

    follows_set = follows_motion = False

    def __init__(self, coordinates: Coordinates, gaps: Gaps, stiffness: float) -> None:
        self._gaps, self._bodies = gaps, coordinates.layout
        self._scales: FloatArray = np.asarray(stiffness * gaps.areas)
        self._P = coordinates.to_displacements
        pairs = len(gaps.local)
        parts = [_Part(coordinates.owned_nodes(b)) for b in range(len(self._bodies.block_sizes))]
        self.layout = Layout(
            self._bodies.comm, [*parts, _Part(pairs)], [*self._bodies.block_sizes, 1]
        )
        self._size = self._bodies.size_local
        self._v = self._bodies.create_vector()
        self._work = self._bodies.create_vector()
        B = gaps.matrix.matMult(self._P)
        scale = B.createVecLeft()
        scale.array[:] = -self._scales
        B.diagonalScale(scale, None)
        scale.destroy()
        self._B, self._Bt = B, B.copy().transpose()
        self._pressures = B.createVecLeft()
        self._C = _zero_diagonal(self._pressures)
        self._A: PETSc.Mat | None = None
        self._nest: PETSc.Mat | None = None
        self._matrix: PETSc.Mat | None = None

    def prepare(self, A: PETSc.Mat) -> None:
        """Do nothing: the method has no numbers of its own."""

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures of all bodies from the unknowns."""
        self._v.array[:] = x.array_r[: self._size]
        self._P.mult(self._v, u)

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return Pᵀ(r + Bᵀλ) and -S g, from the residual r of the bodies."""
        self._P.multTranspose(r, self._work)
        rows = self._work.array_r.copy()
        self._pressures.array[:] = x.array_r[self._size :]
        self._Bt.mult(self._pressures, self._work)
        rows += self._work.array_r
        self._v.array[:] = x.array_r[: self._size]
        self._B.mult(self._v, self._pressures)
        gaps = self._pressures.array_r - self._scales * self._gaps.initial
        return np.concatenate((rows, gaps))

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over A as the nest [[PᵀAP, Bᵀ], [B, C]], assembled."""
        if self._A is None:
            self._A = A.ptap(self._P)
            blocks = [[self._A, self._Bt], [self._B, self._C]]
            self._nest = PETSc.Mat().createNest(blocks, comm=self._bodies.comm)
            self._nest.assemble()
            self._matrix = self._nest.convert("aij", PETSc.Mat())
        else:
            A.ptap(self._P, self._A)
            assert self._nest is not None
            self._nest.convert("aij", self._matrix)

    def matrix(self, closed: BoolArray) -> PETSc.Mat:
        """Return the matrix, whichever pairs are closed: open ones hold their multipliers."""
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m]."""
        return self._gaps.values(u)

    def trial_forces(
        self, x: PETSc.Vec, rows: FloatArray, gaps: FloatArray, closed: BoolArray, stiffness: float
    ) -> FloatArray:
        """Return the multipliers of closed pairs as forces, -stiffness times gap of open ones."""
        return np.where(closed, x.array_r[self._size :] * self._scales, -stiffness * gaps)

    def impose(
        self,
        x: PETSc.Vec,
        forces: FloatArray,
        closed: BoolArray,
        rows: FloatArray,
        held: BoolArray,
        violation: FloatArray,
    ) -> None:
        """Mark the multipliers of open pairs, with their values."""
        open_pairs = self._size + np.flatnonzero(~closed)
        held[open_pairs] = True
        violation[open_pairs] = x.array_r[open_pairs]

    def augment(
        self, forces: FloatArray, closed: BoolArray, balanced: bool, enough: float
    ) -> bool:
        """Return that nothing changed: the multipliers are unknowns."""
        return False

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return the changes of the gaps of closed pairs by motions, shape (motions, closed)."""
        values = np.zeros((len(motions), int(np.count_nonzero(closed))))
        for row in range(len(motions)):
            self._v.array[:] = motions[row, : self._size]
            self._B.mult(self._v, self._pressures)
            values[row] = (self._pressures.array_r / self._scales)[closed]
        return values

    def to_unknowns(self, coordinates: FloatArray) -> FloatArray:
        """Return coordinates with zero pressures behind them."""
        rest = np.zeros((*coordinates.shape[:-1], len(self._gaps.local)))
        return np.concatenate((coordinates, rest), axis=-1)

    def schur_weights(self) -> FloatArray:
        """Return the weights W whose penalty BᵀW⁻¹B is stiff beside the bodies, shape (pairs,)."""
        return np.asarray(self._scales / AUGMENTATION)

    def state(self, closed: BoolArray) -> BoolArray:
        """Return nothing: the matrix is one for all sets."""
        return closed[:0]

    def slide(
        self, x: PETSc.Vec, rows: FloatArray, forces: FloatArray, closed: BoolArray,
        stiffness: float, threshold: float, settled: bool,
    ) -> bool:  # fmt: skip
        """Return that nothing slips: there is no friction."""
        return False

    def along_surface(self, x: PETSc.Vec, rows: FloatArray, closed: BoolArray) -> None:
        """Return nothing: there is no friction."""
        return None

    def commit(self, x: PETSc.Vec) -> None:
        """Do nothing: all that lasts is in the unknowns."""

    def rewind(self, x: PETSc.Vec) -> None:
        """Do nothing, see `commit`."""

    def saved(self) -> dict[str, FloatArray]:
        """Return nothing, see `commit`."""
        return {}

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Do nothing, see `commit`."""

    def destroy(self) -> None:
        """Free matrices and vectors."""
        items = (self._matrix, self._nest, self._A, self._B, self._Bt, self._C, self._v, self._work)
        for item in (*items, self._pressures):
            if item is not None:
                item.destroy()


def _zero_diagonal(vector: PETSc.Vec) -> PETSc.Mat:
    """Return C = 0 with a stored diagonal, on which held multipliers put their identity."""
    sizes = (vector.getSizes(), vector.getSizes())
    C = PETSc.Mat().createAIJ(sizes, nnz=1, comm=vector.getComm())
    first, last = C.getOwnershipRange()
    for row in range(first, last):
        C.setValue(row, row, 0.0)
    C.assemble()
    return C
