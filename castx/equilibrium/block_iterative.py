"""Block-iterative contact (Chiumenti, section 7.3): bodies solved in turn, coupled by a penalty.

The unknowns are parted into blocks: the bodies, each with the springs of its closed pairs, or, as
the arrow-shaped system of the paper is written, the interiors of the bodies and then the nodes of
all interfaces. Each block is solved by Newton's method while the others stay where they are; the
sweeps contract the faster, the softer the penalty. An iteration that is stopped early has moved all
bodies closer to their balance; from there Newton's method for all unknowns ends at it, with one
such sweep as preconditioner of its linear systems.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray
from castx.contact.kinematics.transform import ConstraintTransform
from castx.equilibrium.newton import EquilibriumReport, Newton
from castx.errors import ConvergenceError
from castx.solvers.inner.nest import Block
from castx.solvers.inner.options import FACTORS
from castx.solvers.layout import Layout

_log = logging.getLogger(__name__)


class BlockIteration:
    """Sweeps over blocks until the forces balance, or as often as is allowed.

    A_b du_b = -r_b for one block b after the other, r_b at the present state of all others
    (Chiumenti, section 7.3, iterative solution of the arrow-shaped system).

    Args:
        newton: solves for one block, of which it knows as many as there are.
        blocks: number of blocks.
        most: sweeps after which the present state is taken as it is.
        make_finishing: returns what solves for all blocks together from there; called when needed.
    """

    def __init__(
        self, newton: Newton, blocks: int, most: int, make_finishing: Callable[[], Newton]
    ) -> None:
        self._newton, self._blocks, self._most = newton, blocks, most
        self._make_finishing = make_finishing
        self._finishing: Newton | None = None

    def begin(self) -> None:
        """Expire preconditioners that do not fit what the balance has begun."""
        self._newton.begin()

    def solve(self, x: PETSc.Vec) -> EquilibriumReport:
        """Sweep over the blocks of the unknowns x; leave them at the start if a block fails.

        A soft body beside one that stands still may find no equilibrium where both together do, so
        that the forces are left to `finish`.
        """
        start, closed = x.array_r.copy(), self._newton.balance.active.closed.copy()
        reports: list[EquilibriumReport] = []
        residuals: list[float] = []
        sweeps: list[int] = []
        balanced = False
        while not balanced and len(sweeps) < self._most:
            sweeps.append(len(residuals))
            try:
                for block in range(self._blocks):
                    reports.append(self._newton.solve(x, block))
                    residuals.extend(reports[-1].residuals)
            except ConvergenceError as error:
                _log.debug("a block for itself: %s", error)
                x.array[:], self._newton.balance.active.closed = start, closed
                break
            norm, balanced = self._newton.imbalance(x)
            residuals.append(norm)
        return EquilibriumReport(
            sum(report.iterations for report in reports),
            sum(report.linear_iterations for report in reports),
            sum(report.contact_changes for report in reports),
            tuple(residuals),
            sweeps=tuple(sweeps),
            balanced=balanced,
            linear_solves=tuple(count for report in reports for count in report.linear_solves),
        )

    def finish(self, x: PETSc.Vec, time: float) -> EquilibriumReport:
        """Solve for all unknowns x together, from where the sweeps have left them.

        Raises:
            ConvergenceError: the iteration did not converge.
        """
        if self._finishing is None:
            self._finishing = self._make_finishing()
        self._finishing.balance.begin(x, time)
        self._finishing.begin()
        return self._finishing.solve(x)

    def forget(self) -> None:
        """Drop the factors of matrices."""
        for newton in self._all():
            newton.forget()

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for newton in self._all():
            newton.destroy()

    def _all(self) -> list[Newton]:
        return [newton for newton in (self._newton, self._finishing) if newton is not None]


def arrow_blocks(bodies: Sequence[Block], transform: ConstraintTransform) -> list[Block]:
    """Return the interiors of the bodies and the nodes of all interfaces as the last block.

    Args:
        bodies: the unknowns of each body.
        transform: change of unknowns of all bodies.
    """
    layout, facing = transform.layout, transform.facing()
    return [*_interiors(bodies, layout, facing), _interface(layout, facing)]


def _interiors(bodies: Sequence[Block], layout: Layout, facing: BoolArray) -> Iterator[Block]:
    for b, body in enumerate(bodies):
        inside = ~facing[layout.local_slice(b)]
        rows = PETSc.IS().createGeneral(body.rows.getIndices()[inside], comm=layout.comm)
        rows.setBlockSize(layout.block_sizes[b])
        yield Block(rows, body.modes[:, inside], body.options)


def _interface(layout: Layout, facing: BoolArray) -> Block:
    numbers = np.flatnonzero(facing).astype(np.int32) + layout.first
    rows = PETSc.IS().createGeneral(numbers.astype(np.int32), comm=layout.comm)
    return Block(rows, np.zeros((0, len(numbers))), FACTORS)
