"""Matrix of condensed contact whose pairs slip: rows of motion bear μ times the row of the gap."""

from __future__ import annotations

from dataclasses import dataclass, replace

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.coulomb import SlidingRows
from castx.contact.kinematics.gaps import Gaps
from castx.solvers.layout import Layout


@dataclass(frozen=True)
class SlipState:
    """Friction as last imposed, of the rows with friction.

    Attributes:
        slips: rows that slip, shape (n,).
        force: μ p S of those, else zero [N], shape (n,).
        along: unit vectors d of the motions, shorter where springs hold, shape (n, dimension - 1).
        moved: motions since the last accepted step [m], shape (n, dimension - 1).
        chatters: rows that slip held by springs, shape (n,).
        carried: w, the forces against the motions that the rows are left with, over μ p S or over
            their size if that is more; d where no spring acts, shape (n, dimension - 1).
        springs: stiffness c of the springs [N/m].
    """

    slips: BoolArray
    force: FloatArray
    along: FloatArray
    moved: FloatArray
    chatters: BoolArray
    carried: FloatArray
    springs: float

    @classmethod
    def none(cls, count: int, width: int) -> SlipState:
        """Return rows that stick without slip so far."""
        still, nowhere = np.zeros((count, width)), np.zeros(count, dtype=bool)
        return cls(nowhere, np.zeros(count), still, still, nowhere, still, 0.0)

    def without_slip(self) -> SlipState:
        """Return the state with all rows sticking."""
        nowhere = np.zeros_like(self.slips)
        return replace(self, slips=nowhere, chatters=nowhere)

    @property
    def holds(self) -> BoolArray:
        """Rows whose springs bear less than friction can, shape (n,)."""
        drawn = self.springs * np.linalg.norm(self.moved, axis=1)
        return np.asarray(self.chatters & (drawn < self.force))

    def resisted(self, motions: FloatArray) -> FloatArray:
        """Return the parts of motions that friction of chattering rows resists at once.

        That is all where their springs hold, and what goes across their motion where they slip.

        Args:
            motions: along the surface, shape (motions, n, dimension - 1).

        Returns:
            Shape (motions, rows).
        """
        free = np.where(self.holds[:, None], 0.0, self.along)
        rest = motions - np.einsum("mnk,nk->mn", motions, free)[:, :, None] * free
        return np.asarray(rest[:, self.chatters & (self.force > 0)].reshape(len(motions), -1))

    def turning(self, follows: BoolArray, steepest: float) -> FloatArray:
        """Return the derivatives of μ p S d over the motions [N/m], (n, dimension - 1, same).

        They are μ p S (1 - w dᵀ)/|Δv|, and c where a spring holds. What chatters is far from
        balance: with w in place of d the friction that its row lacks resists the motion too (S.
        Hüeber, G. Stadler and B. I. Wohlmuth, SIAM J. Sci. Comput. 30 (2008) 572).

        Args:
            follows: rows that slip in a direction that follows their motion.
            steepest: largest stiffness that counts [N/m].
        """
        size, width = np.linalg.norm(self.moved, axis=1), self.moved.shape[1]
        ahead = np.sum(self.moved * self.along, axis=1) > 0.0
        turns = ahead & (follows | self.chatters)
        slope = np.divide(self.force, size, out=np.zeros_like(size), where=turns)
        # Steeper than the bodies it would only spoil the matrix.
        slope = np.minimum(slope, steepest)[:, None, None]
        found = slope * (np.eye(width) - self.carried[:, :, None] * self.along[:, None, :])
        found[self.holds] = self.springs * np.eye(width)
        return np.asarray(found)


def matrix_with_slip(
    normal: PETSc.Mat,
    layout: Layout,
    gaps: Gaps,
    sliding: SlidingRows,
    state: SlipState,
    turning: BoolArray,
    steepest: float,
) -> PETSc.Mat:
    """Return the derivative of r_t + μ r_n d in the rows that slip; the caller destroys it.

    Args:
        normal: matrix of the unknowns without friction.
        layout: numbering of the unknowns.
        gaps: the pairs of all interfaces.
        sliding: the rows with friction.
        state: friction as last imposed.
        turning: rows that slip in a direction that follows their motion.
        steepest: largest stiffness μ p S/|Δv| that counts [N/m].
    """
    diagonal = layout.create_vector()
    rows = PETSc.Mat().createAIJ(
        ((layout.size_local, layout.size_global),) * 2, nnz=4, comm=layout.comm
    )
    rows.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    diagonal.set(1.0)
    rows.setDiagonal(diagonal)
    diagonal.destroy()
    first, gap = layout.first, gaps.local[sliding.rows]
    pressed = state.slips & (state.force > 0) & ~state.holds
    shares = np.where(pressed, sliding.coefficient, 0.0)[:, None] * state.along
    for i, k in np.argwhere(sliding.local >= 0):
        place = first + int(sliding.local[i, k])
        rows.setValue(place, first + int(gap[i]), shares[i, k])
    rows.assemble()
    product = rows.matMult(normal)
    rows.destroy()
    _add_turning(product, first, sliding, state.turning(turning, steepest))
    return product


def _add_turning(product: PETSc.Mat, first: int, sliding: SlidingRows, blocks: FloatArray) -> None:
    """Add the derivatives of friction that turns with the motion, (n, dimension - 1, same)."""
    product.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    for i in np.flatnonzero(np.any(blocks != 0.0, axis=(1, 2))):
        there = sliding.local[i] >= 0
        numbers = (first + sliding.local[i][there]).astype(np.int32)
        product.setValues(
            numbers, numbers, blocks[i][np.ix_(there, there)], PETSc.InsertMode.ADD_VALUES
        )
    product.assemble()
