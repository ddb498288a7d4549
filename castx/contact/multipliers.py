"""Contact by Lagrange multipliers (Chiumenti, section 8), the three-block arrow-shaped system.

    [ A   Bᵀ ] [ v ]
    [ B   0  ] [ λ ]

with B = -S ∂g/∂u, λ = p_c ≥ 0 and, for a closed pair, B u = S g0; an open pair has λ = 0.
"""

from __future__ import annotations

from typing import NamedTuple

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.kinematics.node_rows import owned_nodes
from castx.contact.kinematics.transform import ConstraintTransform
from castx.solvers.layout import Layout

AUGMENTATION = 50.0
"""Penalty of the augmented block of the bodies, in units of G/L."""


class _Part(NamedTuple):
    """The number of nodes of one part of a layout on this rank."""

    size_local: int


class MultiplierUnknowns:
    """The unknowns v of the bodies, then a scaled pressure for each pair.

    Attributes:
        layout: numbering of all unknowns.
        bodies: that of v.
        P: u = P v.
        B: -S ∂g/∂v in units of `scales`.
        Bt: its transpose.
        scales: force per unknown of each pair [N], shape (pairs,).

    Args:
        transform: change of unknowns of all bodies, in which gaps are no unknowns.
        gaps: the pairs of all interfaces.
        stiffness: pressure per length that makes lengths of the multipliers [Pa/m], so that all
            rows are forces.
    """

    def __init__(self, transform: ConstraintTransform, gaps: Gaps, stiffness: float) -> None:
        self._gaps, self.bodies, self.P = gaps, transform.layout, transform.P
        self.scales: FloatArray = np.asarray(stiffness * gaps.areas)
        sizes = self.bodies.block_sizes
        parts = [_Part(owned_nodes(self.bodies, b)) for b in range(len(sizes))]
        self.layout = Layout(self.bodies.comm, [*parts, _Part(len(gaps.local))], [*sizes, 1])
        self._v = self.bodies.create_vector()
        self._work = self.bodies.create_vector()
        self.B = gaps.matrix.matMult(self.P)
        scale = self.B.createVecLeft()
        scale.array[:] = -self.scales
        self.B.diagonalScale(scale, None)
        scale.destroy()
        self.Bt = self.B.copy().transpose()
        self._pressures = self.B.createVecLeft()

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set u = P v."""
        self._v.array[:] = x.array_r[: self.bodies.size_local]
        self.P.mult(self._v, u)

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return Pᵀ(r + Bᵀλ) and -S g, from the residual r of the bodies."""
        self.P.multTranspose(r, self._work)
        rows = self._work.array_r.copy()
        self._pressures.array[:] = x.array_r[self.bodies.size_local :]
        self.Bt.mult(self._pressures, self._work)
        rows += self._work.array_r
        gaps = self.gap_changes(x.array_r) - self.scales * self._gaps.initial
        return np.concatenate((rows, gaps))

    def gap_changes(self, x: FloatArray) -> FloatArray:
        """Return B v of owned unknowns x, in the units of `scales`, shape (pairs,)."""
        self._v.array[:] = x[: self.bodies.size_local]
        self.B.mult(self._v, self._pressures)
        changes: FloatArray = self._pressures.array_r
        return changes

    def extended(self, v: FloatArray) -> FloatArray:
        """Return v with zero pressures behind it."""
        rest = np.zeros((*v.shape[:-1], len(self._gaps.local)))
        return np.concatenate((v, rest), axis=-1)

    def destroy(self) -> None:
        """Free matrices and vectors."""
        for item in (self.B, self.Bt, self._v, self._work, self._pressures):
            item.destroy()


class MultiplierContact:
    """Open pairs as Dirichlet conditions on their multipliers, λ = 0.

    Attributes:
        unknowns: those of the bodies and the multipliers.

    Args:
        unknowns: those of the bodies and the multipliers.
        gaps: the pairs of all interfaces.
    """

    follows_set, is_linear = False, True

    def __init__(self, unknowns: MultiplierUnknowns, gaps: Gaps) -> None:
        self.unknowns, self._gaps = unknowns, gaps
        self._size = unknowns.bodies.size_local
        self._C = _zero_diagonal(unknowns.B)
        self._A: PETSc.Mat | None = None
        self._nest: PETSc.Mat | None = None
        self._matrix: PETSc.Mat | None = None

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over A as the nest [[PᵀAP, Bᵀ], [B, C]], assembled."""
        unknowns = self.unknowns
        if self._A is None:
            self._A = A.ptap(unknowns.P)
            blocks = [[self._A, unknowns.Bt], [unknowns.B, self._C]]
            self._nest = PETSc.Mat().createNest(blocks, comm=unknowns.layout.comm)
            self._nest.assemble()
            self._matrix = self._nest.convert("aij", PETSc.Mat())
        else:
            A.ptap(unknowns.P, self._A)
            assert self._nest is not None
            self._nest.convert("aij", self._matrix)

    def matrix(self, iterate: PairIterate) -> PETSc.Mat:
        """Return the matrix, whichever pairs are closed: open ones constrain their multipliers."""
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m]."""
        return self._gaps.values(u)

    def trial_forces(self, iterate: PairIterate) -> FloatArray:
        """Return the forces of closed pairs, minus stiffness times gap of open ones."""
        carried = iterate.x.array_r[self._size :] * self.unknowns.scales
        return np.where(iterate.closed, carried, -iterate.stiffness * iterate.gaps)

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Constrain the multipliers of open pairs at zero."""
        open_pairs = (self._size + np.flatnonzero(~iterate.closed)).astype(np.int32)
        rows.constrain(open_pairs, iterate.x.array_r[open_pairs])

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return the scaled gap changes of closed pairs under motions, shape (motions, closed)."""
        values = np.zeros((len(motions), int(np.count_nonzero(closed))))
        for row in range(len(motions)):
            changes = self.unknowns.gap_changes(motions[row]) / self.unknowns.scales
            values[row] = changes[closed]
        return values

    def schur_weights(self) -> FloatArray:
        """Return the weights W whose penalty BᵀW⁻¹B is stiff beside the bodies, shape (pairs,)."""
        return np.asarray(self.unknowns.scales / AUGMENTATION)

    def destroy(self) -> None:
        """Free matrices and vectors."""
        for item in (self._matrix, self._nest, self._A, self._C):
            if item is not None:
                item.destroy()
        self.unknowns.destroy()


def _zero_diagonal(rows: PETSc.Mat) -> PETSc.Mat:
    """Return C = 0 with a stored diagonal, on which constrained multipliers put their identity."""
    sizes = rows.getSizes()[0]
    C = PETSc.Mat().createAIJ((sizes, sizes), nnz=1, comm=rows.getComm())
    first, last = C.getOwnershipRange()
    for row in range(first, last):
        C.setValue(row, row, 0.0)
    C.assemble()
    return C
