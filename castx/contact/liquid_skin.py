"""Liquid at the wall: pairs that cannot open, since metal that is not coherent follows the wall.

A liquid cannot leave a wall: the air would have to pass through it, and what the wall leaves free
is filled by metal that flows there. So a pair is held closed, whatever the sign of its force, as
long as no cell at one of its nodes is coherent. The cells decide, not the solid fraction of the
node, since they carry the stress: held with a coherent cell, a pair would store a suction in it,
and released with none, the liquid would leave the wall. At a chilled wall the node is ahead of its
cells by up to the whole freezing range.

A pair that melts again closes again. One that was given a gap that is positive without any
displacement never is held: there is no metal at that wall.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from petsc4py import PETSc

import numpy as np
from dolfinx import la

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.liquid_column import column_pressure
from castx.mechanics.body import BodyMechanics
from castx.mechanics.liquid.regions import CellRegions
from castx.solvers.layout import Layout
from castx.solvers.remote_entries import RemoteEntries


@dataclass(frozen=True)
class _Side:
    """The nodes of one body at the rows of an interface.

    Attributes:
        rows: of the interface.
        entries: entries of the first unknown of the nodes, one object for each corner of a facet.
        weights: of these nodes, (rows, corners).
    """

    rows: slice
    entries: tuple[RemoteEntries, ...]
    weights: FloatArray

    def get(self, vector: PETSc.Vec) -> FloatArray:
        """Return the values at the nodes, shape (rows, corners); collective."""
        return np.column_stack([entry.get(vector) for entry in self.entries])


class LiquidSkin:
    """Finds the pairs that a liquid holds closed, and the pressure of its column there.

    A pair that was released keeps free until the end of the step: heat and mechanics would
    alternate otherwise, since a gap delays the freezing that opened it.

    Args:
        layout: numbering of the unknowns of all bodies.
        bodies: in the order of the layout.
        gaps: the pairs of all interfaces.
    """

    def __init__(self, layout: Layout, bodies: Sequence[BodyMechanics], gaps: Gaps) -> None:
        self._layout, self._bodies = layout, list(bodies)
        self._regions = {b.name: CellRegions(b.mesh) for b in bodies if not b.is_compressible}
        self._can_hold = gaps.free & (gaps.at_rest <= 0.0)
        self._values = layout.create_vector()
        self._sides = list(self._find_sides(gaps))
        self._released: BoolArray = np.zeros(len(gaps.free), dtype=bool)

    def _find_sides(self, gaps: Gaps) -> Iterator[_Side]:
        numbers = {b.name: n for n, b in enumerate(self._bodies) if b.name in self._regions}
        for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
            pairs, index = interface.pairs, interface.index
            nodes, weights = pairs.partners
            own = (pairs.secondary, pairs.secondary_nodes[:, None], np.ones((len(nodes), 1)))
            for name, corners, shares in (own, (pairs.primary, nodes, weights)):
                if name in numbers:
                    dofs = [self._layout.dofs(numbers[name], n) for n in corners[index].T]
                    entries = tuple(RemoteEntries(self._values, of) for of in dofs)
                    yield _Side(part, entries, shares[index])

    def held(self) -> BoolArray:
        """Return the rows held closed in the present state of the bodies, (rows,); collective."""
        if not self._sides:
            return np.zeros_like(self._can_hold)
        self._fill([_coherent_nodes(body) for body in self._bodies])
        solid = np.ones(len(self._can_hold), dtype=bool)
        for side in self._sides:
            touched = (side.get(self._values) > 0.0) & (side.weights > 0.0)
            solid[side.rows] &= touched.any(axis=1)
        self._released |= solid
        return np.asarray(self._can_hold & ~self._released)

    def pressures(self) -> FloatArray:
        """Return the pressure of the liquid column at all rows [Pa], (rows,); collective.

        It rests below the highest point of the liquid that is connected to the node, and is zero
        where there is none.
        """
        found = np.zeros(len(self._can_hold))
        if not self._sides or not any(body.loads.weighs for body in self._bodies):
            return found
        self._fill([self._column(body) for body in self._bodies])
        for side in self._sides:
            column = np.sum(side.get(self._values) * side.weights, axis=1)
            found[side.rows] = np.maximum(found[side.rows], column)
        return found

    def _fill(self, nodal: Sequence[FloatArray]) -> None:
        """Give the first unknown of each node a value of its body."""
        for b, (body, values) in enumerate(zip(self._bodies, nodal, strict=True)):
            own = self._values.array[self._layout.local_slice(b)]
            own[:: body.block_size] = values[: body.owned_nodes]

    def _column(self, body: BodyMechanics) -> FloatArray:
        """Return the pressure of the column at the local nodes of a body [Pa]; collective."""
        head = body.loads.potential()
        if body.name not in self._regions:
            return np.zeros_like(head)
        return column_pressure(self._regions[body.name], ~body.coherent, head)

    def forget(self) -> None:
        """Begin another step, in which no pair has been released."""
        self._released[:] = False

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for side in self._sides:
            for entry in side.entries:
                entry.destroy()
        self._values.destroy()


def _coherent_nodes(body: BodyMechanics) -> FloatArray:
    """Return 1 at local nodes with a coherent cell on any rank, 0 at others; collective."""
    index_map = body.mesh.nodes.dofmap.index_map
    if body.is_compressible:
        return np.ones(index_map.size_local + index_map.num_ghosts)
    flags = la.vector(index_map, 1, dtype=np.int32)
    flags.array[:] = 0
    flags.array[body.cell_nodes[body.coherent].ravel()] = 1
    flags.scatter_reverse(la.InsertMode.add)
    return np.asarray(flags.array > 0, dtype=np.float64)
