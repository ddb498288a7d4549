"""Friction of penalty contact: return mapping of the tractions along the surface.

The trial traction of a closed pair is that of the last accepted step and ε times its motion since;
where it exceeds μ p it is scaled back to it, and the pair slips (Wriggers 2006, section 10.5).
Which pairs slip is decided once in an iteration, and at first all stick: the elastic predictor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.coulomb import SlidingRows, turned, unit
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps, fill_directions


class PenaltyFriction:
    """Forces along the surface and their derivatives.

    Args:
        coordinates: coordinates of all bodies.
        body_names: names of the bodies in the order of the layout.
        gaps: the pairs of all interfaces.
        sliding: the rows with friction.
    """

    def __init__(
        self,
        coordinates: Coordinates,
        body_names: Sequence[str],
        gaps: Gaps,
        sliding: SlidingRows,
    ) -> None:
        self._gaps, self._sliding = gaps, sliding
        tangents = _tangent_matrix(coordinates, list(body_names), gaps, sliding)
        self._G = tangents.matMult(coordinates.to_displacements)
        tangents.destroy()
        self._Gt = self._G.copy().transpose()
        self._values = self._G.createVecLeft()
        self._work = coordinates.layout.create_vector()
        shape = sliding.tangents.shape[:2]
        self._place, self._committed = np.zeros(shape), np.zeros(shape)
        # As last imposed: springs, trial and actual forces, what slips.
        self._springs: FloatArray = np.zeros(shape[0])
        self._trial, self._force = np.zeros(shape), np.zeros(shape)
        self._direction: FloatArray = np.zeros(shape)
        self._normal: FloatArray = np.zeros(shape[0])
        self._touching: BoolArray = np.zeros(shape[0], dtype=bool)
        some: BoolArray = np.any(sliding.tangents != 0.0, axis=(1, 2))
        # "Closed" are those that stick.
        keys = gaps.keys()[sliding.rows]
        self._sticks = ActiveSet(coordinates.layout.comm, np.zeros(shape[0]), some, keys)
        self._matrix: PETSc.Mat | None = None

    def _motion(self, x: PETSc.Vec) -> FloatArray:
        """Return how far pairs have moved along the surface in this step [m]."""
        self._G.mult(x, self._values)
        moved = self._values.array_r.reshape(self._place.shape)
        return np.asarray(moved - self._sliding.led() - self._place)

    def begin(self) -> None:
        """Start a solve from pairs that stick."""
        self._touching = np.zeros_like(self._touching)
        self._sticks.closed[:] = True
        self._sticks.begin()

    def state(self) -> BoolArray:
        """Return which pairs stick, on which the matrix depends."""
        return self._sticks.closed

    @property
    def _slips(self) -> BoolArray:
        return self._touching & ~self._sticks.closed

    def update(self, closed: BoolArray, threshold: float, settled: bool) -> bool:
        """Let pairs slip or stick that violate their state; return whether any did, on any rank.

        Args:
            closed: the present set of closed pairs.
            threshold: force that is noise [N].
            settled: whether what sticks may begin to slip.
        """
        touching = closed[self._sliding.rows]
        most = self._sliding.coefficient * self._normal
        size = np.linalg.norm(self._trial, axis=1)
        forward = np.sum(self._trial * self._direction, axis=1)
        present = self._sticks.closed.copy()
        directions, before = self._directions(), self._sticks.closed | ~touching
        known = touching & self._touching
        if self._sticks.any(touching != self._touching):
            # What comes into contact and has moved slips at once.
            self._sticks.closed = before & (known | (size <= most + threshold))
            self._sticks.forget()
        # One that would slip the other way sticks before.
        inside = most - np.where(self._sticks.closed, size, forward)
        may = known & (settled | ~self._sticks.closed)
        self._sticks.update(np.where(may, inside, 0.0), threshold)
        # Of the two, slip never bears more than friction can.
        self._sticks.closed &= ~self._sticks.frozen
        begins = before & ~self._sticks.closed
        self._direction = np.where(begins[:, None], unit(self._trial, directions), directions)
        return self._sticks.any(touching & (self._sticks.closed != present))

    def _directions(self) -> FloatArray:
        """Return unit vectors along the trial forces, the last ones where they turned back."""
        return turned(self._trial, self._direction)

    def impose(
        self, x: PETSc.Vec, forces: FloatArray, closed: BoolArray, springs: FloatArray,
        rows: FloatArray,
    ) -> None:  # fmt: skip
        """Add the forces along the surface to rows.

        Args:
            x: the unknowns.
            forces: normal forces of all rows [N].
            closed: the present set of closed pairs.
            springs: ε S of all rows [N/m].
            rows: changed in place.
        """
        chosen = self._sliding.rows
        self._touching, self._springs = closed[chosen], springs[chosen]
        self._normal = np.maximum(forces[chosen], 0.0)
        most = self._sliding.coefficient * self._normal
        self._trial = self._committed + self._springs[:, None] * self._motion(x)
        slipping = most[:, None] * self._directions()
        self._force = np.where(self._slips[:, None], slipping, self._trial)
        self._force[~self._touching] = 0.0
        self._values.array[:] = self._force.ravel()
        self._Gt.mult(self._values, self._work)
        rows += self._work.array_r

    def matrix(self, normal: PETSc.Mat) -> PETSc.Mat:
        """Return the derivative of the forces as last imposed; the next call overwrites it.

        Args:
            normal: ∂g/∂v of all rows.
        """
        along, across = self._derivatives()
        product = along.matMult(self._G)
        rest = across.matMult(normal)
        product.axpy(1.0, rest)
        if self._matrix is not None:
            self._matrix.destroy()
        self._matrix = self._Gt.matMult(product)
        for item in (along, across, product, rest):
            item.destroy()
        return self._matrix

    def _derivatives(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Return the derivatives of the forces over the motions and over the gaps.

        Where a pair slips, T = μ f d with d = T_trial/|T_trial| and f = -ε S g.
        """
        count, width = self._trial.shape
        size, d = np.linalg.norm(self._trial, axis=1), self._directions()
        stick = np.where(self._touching & ~self._slips, self._springs, 0.0)
        most = self._sliding.coefficient * self._normal
        follows = self._slips & (np.sum(self._trial * d, axis=1) > 0.0)
        turning = np.divide(most * self._springs, size, out=np.zeros(count), where=follows)
        blocks = stick[:, None, None] * np.eye(width)
        blocks += turning[:, None, None] * (np.eye(width) - d[:, :, None] * d[:, None, :])
        pressed = self._slips & (self._normal > 0)
        pressing = np.where(pressed, self._sliding.coefficient * self._springs, 0.0)
        columns = -pressing[:, None] * d
        own = self._G.getOwnershipRange()[0] + np.arange(count * width).reshape(count, width)
        gaps = self._gaps.matrix.getOwnershipRange()[0] + self._sliding.rows
        along = _sparse(self._G, self._G, width)
        across = _sparse(self._G, self._gaps.matrix, 1)
        for i in range(count):
            numbers = own[i].astype(np.int32)
            along.setValues(numbers, numbers, blocks[i])
            across.setValues(numbers, np.int32(gaps[i]), columns[i])
        along.assemble()
        across.assemble()
        return along, across

    def held_motions(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return how motions move closed pairs that stick, shape (motions, rows); collective."""
        holds = np.repeat(closed[self._sliding.rows] & self._sticks.closed, self._place.shape[1])
        values = np.zeros((len(motions), int(np.count_nonzero(holds))))
        for row, motion in enumerate(motions):
            self._work.array[:] = motion
            self._G.mult(self._work, self._values)
            values[row] = self._values.array_r[holds]
        return values

    def vectors(self) -> FloatArray:
        """Return the friction on the secondary nodes of all rows [N], shape (rows, dimension)."""
        return self._sliding.vectors(-self._force)

    def commit(self, x: PETSc.Vec) -> None:
        """Let the next step begin with the present tractions and places, at unknowns x."""
        self._committed = self._force.copy()
        self._place += self._motion(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the places of the last accepted step, whose unknowns are x."""
        self._place += self._motion(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return the committed forces along the surface of all rows."""
        found: dict[str, FloatArray] = {}
        for k in range(self._committed.shape[1]):
            values = np.zeros(len(self._gaps.local))
            values[self._sliding.rows] = self._committed[:, k]
            found[f"friction_{k}"] = values
        return found

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back committed forces along the surface."""
        for k in range(self._committed.shape[1]):
            self._committed[:, k] = arrays[f"friction_{k}"][self._sliding.rows]

    def destroy(self) -> None:
        """Free matrices and vectors."""
        for item in (self._matrix, self._G, self._Gt, self._values, self._work):
            if item is not None:
                item.destroy()


def _tangent_matrix(
    coordinates: Coordinates, names: list[str], gaps: Gaps, sliding: SlidingRows
) -> PETSc.Mat:
    """Return the motions along the surface over the displacements, row after row."""
    layout = coordinates.layout
    count, width = sliding.tangents.shape[:2]
    sizes = ((count * width, PETSc.DETERMINE), (layout.size_local, layout.size_global))
    T = PETSc.Mat().createAIJ(sizes, nnz=8, comm=layout.comm)
    T.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    first = T.getOwnershipRange()[0]
    for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
        mine = np.flatnonzero((sliding.rows >= part.start) & (sliding.rows < part.stop))
        pairs, index = interface.pairs, interface.index[sliding.rows[mine] - part.start]
        nodes, weights = pairs.partners
        own = (pairs.secondary, pairs.secondary_nodes[:, None], np.ones((len(nodes), 1)))
        for name, numbers, shares in (own, (pairs.primary, nodes, -weights)):
            for k in range(width if name in names else 0):
                rows = (first + mine * width + k).astype(np.int32)
                b, directions = names.index(name), sliding.tangents[mine, k]
                fill_directions(T, layout, b, rows, numbers[index], shares[index], directions)
    T.assemble()
    return T


def _sparse(rows: PETSc.Mat, columns: PETSc.Mat, width: int) -> PETSc.Mat:
    """Return an empty matrix between the rows of two matrices."""
    sizes = (rows.getSizes()[0], columns.getSizes()[0])
    return PETSc.Mat().createAIJ(sizes, nnz=width, comm=rows.getComm())
