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
        along: unit vectors d of the motions, shape (n, dimension - 1).
        moved: motions since the last accepted step [m], shape (n, dimension - 1).
    """

    slips: BoolArray
    force: FloatArray
    along: FloatArray
    moved: FloatArray

    @classmethod
    def none(cls, count: int, width: int) -> SlipState:
        """Return rows that stick without slip so far."""
        still = np.zeros((count, width))
        return cls(np.zeros(count, dtype=bool), np.zeros(count), still, still.copy())

    def without_slip(self) -> SlipState:
        """Return the state with all rows sticking."""
        return replace(self, slips=np.zeros_like(self.slips))


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
    pressed = state.slips & (state.force > 0)
    shares = np.where(pressed, sliding.coefficient, 0.0)[:, None] * state.along
    for i, k in np.argwhere(sliding.local >= 0):
        place = first + int(sliding.local[i, k])
        rows.setValue(place, first + int(gap[i]), shares[i, k])
    rows.assemble()
    product = rows.matMult(normal)
    rows.destroy()
    if state.along.shape[1] > 1:
        _add_turning(product, first, sliding, state, turning, steepest)
    return product


def _add_turning(
    product: PETSc.Mat, first: int, sliding: SlidingRows, state: SlipState,
    turning: BoolArray, steepest: float,
) -> None:  # fmt: skip
    """Add μ p S ∂d/∂v = μ p S (1 - d dᵀ)/|Δv|: friction turns with the motion."""
    size = np.linalg.norm(state.moved, axis=1)
    product.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    ahead = np.sum(state.moved * state.along, axis=1) > 0.0
    for i in np.flatnonzero(turning & ahead):
        there, d = sliding.local[i] >= 0, state.along[i]
        # Steeper than the bodies it would only spoil the matrix.
        slope = min(state.force[i] / size[i], steepest)
        block = slope * (np.eye(len(d)) - np.outer(d, d))
        numbers = (first + sliding.local[i][there]).astype(np.int32)
        product.setValues(
            numbers, numbers, block[np.ix_(there, there)], PETSc.InsertMode.ADD_VALUES
        )
    product.assemble()
