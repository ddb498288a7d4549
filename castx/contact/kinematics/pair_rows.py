"""Rows of the pairs of an interface, and rows that a condition prescribes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.contact.kinematics.midside_shares import MidsideShares
from castx.contact.kinematics.rows import Treatment
from castx.domain.pairs.facet_pairs import FacetPairs
from castx.domain.pairs.node_pairs import NodePairs
from castx.stateful import Numbering, numbered_at_nodes
from castx.tables import Table


@dataclass(frozen=True)
class Prescribed:
    """Owned entries of v that a condition prescribes, with their displacement over time [m]."""

    local: IntArray
    value: Table


@dataclass
class EqualMotion:
    """Nodes of a surface that move equally along a direction, those of this rank.

    Attributes:
        body: its number.
        nodes: local numbers of owned nodes, shape (n,).
        slots: row of each of them, shape (n,).
        first: index of the node to which the others are relative; None: it is on another rank.
        tied_by: pairs that tie this node; None: nothing does.
        pair: number of its pair among them, on its rank.
    """

    body: int
    nodes: IntArray
    slots: IntArray
    first: int | None = None
    tied_by: NodePairs | None = None
    pair: int = 0


class MidsideMotions(NamedTuple):
    """Part of the mid-sides of one body in motions of rows.

    Attributes:
        name: of the mid-sides in the layout of all unknowns.
        rows: in which they count, shape (n,).
        midsides: their global numbers, shape (n,).
        weights: of their motions, shape (n,).
        directions: along which their motions count, shape (n, dimension).
    """

    name: str
    rows: IntArray
    midsides: LongArray
    weights: FloatArray
    directions: FloatArray


@dataclass(frozen=True)
class PairRows:
    """Where the rows of the pairs of one interface stand among the unknowns.

    Attributes:
        pairs: the node pairs.
        index: number of the pair of each row, shape (rows,).
        normals: normals that respect the symmetry planes, shape (rows, dimension).
        areas: contact areas [m²] that turn forces into pressures, shape (rows,).
        local: local number in v of each row's gap, shape (rows,); -1 where no normal motion is
            free.
        treatment: what the change of unknowns makes of the rows.
        tangents: orthonormal directions along the surface that are free, zero where there are
            fewer, shape (rows, dimension - 1, dimension); of tied pairs none.
        tangent_local: local number in v of the motion along each, -1 where it is no unknown,
            shape (rows, dimension - 1).
        midsides: what the mid-sides of quadratic bodies have in the pairs, each of which has one
            row then.
        facets: round the pairs, each of which has one row then; None: nothing asks for them.
    """

    pairs: NodePairs
    index: IntArray
    normals: FloatArray
    areas: FloatArray
    local: IntArray
    treatment: Treatment
    tangents: FloatArray
    tangent_local: IntArray
    midsides: Sequence[MidsideShares] = ()
    facets: FacetPairs | None = None

    @property
    def numbering(self) -> Numbering:
        """The rows by the numbers of their secondary nodes and their order at each node."""
        nodes = self.pairs.original_nodes[self.index]
        bodies = (self.pairs.secondary, self.pairs.primary)
        return numbered_at_nodes(f"rows of {self.pairs.name}", nodes, bodies)

    @property
    def free(self) -> BoolArray:
        """Mask of the rows that carry a constraint."""
        return self.local >= 0

    def midsides_in_gaps(self) -> Iterator[MidsideMotions]:
        """Yield the part of mid-sides in the gaps, of one quadratic body after the other.

        They count along the area vectors of their edges, which lean where the surface is round.
        """
        yield from self._of_midsides()

    def midsides_along(self, directions: FloatArray) -> Iterator[MidsideMotions]:
        """Yield the part of mid-sides in motions along other directions.

        Args:
            directions: of the motions of the rows, shape (rows, dimension).
        """
        for found in self._of_midsides():
            yield found._replace(directions=directions[found.rows])

    def _of_midsides(self) -> Iterator[MidsideMotions]:
        for shares in self.midsides:
            pressed = np.flatnonzero(self.areas[shares.pair] > 0)
            rows, midsides = shares.pair[pressed], shares.midsides[pressed]
            weights = shares.sign * shares.areas[pressed] / self.areas[rows]
            yield MidsideMotions(shares.name, rows, midsides, weights, shares.normals[pressed])
