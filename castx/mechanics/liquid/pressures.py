"""Pressures of trapped liquid: where a pocket closed, and where pores open in it.

Pores open at the depression p_c at the highest point of a pocket, and below it, with the depth h,
at p = p_c − ρ g h (tension positive): the weight of the liquid above keeps them shut.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.domain.mesh import BodyMesh
from castx.mechanics.liquid.content import Content
from castx.stateful import Arrays, Saved


class PocketPressures:
    """Pressures at the nodes of the pockets of one body.

    Args:
        body: mesh of the body.
        potential: x·b of the body force b at the local nodes [Pa], shape (nodes,), or one value.
        cavitation: p_c [Pa].

    Attributes:
        limit: pressure at which pores open, at the nodes in a pocket [Pa], shape (nodes,).
        reference: pressure at which a pocket closed, at the nodes in it [Pa], shape (nodes,).
        at_closing: mean of the reference over the limit in each pocket [Pa], shape (pockets,).
    """

    def __init__(
        self, body: BodyMesh, potential: FloatArray | float, cavitation: float
    ) -> None:
        self._body, self._cavitation = body, cavitation
        self._cell_nodes: IntArray = body.nodes.dofmap.list
        # The pressure at rest, tension positive, but for a constant.
        self._head: FloatArray = np.zeros(len(body.parent_vertices)) - potential
        highest = body.mesh.comm.allreduce(float(self._head.max(initial=-np.inf)), op=MPI.MAX)
        # Liquid that is trapped from the start is at rest, with no pressure at the highest node.
        self._last: FloatArray = self._head - highest
        self._committed = self.reference = self.limit = self._last
        self.at_closing: FloatArray = np.zeros(0)
        self._trapped: IntArray = np.zeros((0, self._cell_nodes.shape[1]), dtype=np.int32)
        self._pocket: IntArray = np.zeros(0, dtype=np.int32)

    def begin(self, content: Content) -> None:
        """Find the pressures of a trial step whose pockets are known; collective."""
        pocket, corners = content.pocket, self._cell_nodes
        trapped, before = pocket >= 0, content.was_trapped
        closing = np.zeros(len(self._last), dtype=bool)
        closing[corners[trapped & ~before].ravel()] = True
        closing[corners[trapped & before].ravel()] = False
        self.reference = np.where(closing, self._last, self._committed)
        top = content.largest(self._head[corners].max(axis=1))
        self.limit = np.full(len(closing), self._cavitation)
        nodes = corners[trapped]
        self.limit[nodes] += self._head[nodes] - top[pocket[trapped]][:, None]

        self.at_closing = content.mean(self.of_cells(self.reference - self.limit))
        self._trapped, self._pocket = nodes, pocket[trapped]

    def acting(self, excess: FloatArray) -> FloatArray:
        """Return the pressures at the nodes in pockets, elsewhere the references [Pa], (nodes,).

        Args:
            excess: of each pocket over its limit [Pa], shape (pockets,).
        """
        acting = self.reference.copy()
        acting[self._trapped] = self.limit[self._trapped] + excess[self._pocket][:, None]
        return acting

    def of_cells(self, nodal: FloatArray) -> FloatArray:
        """Return the means of nodal pressures in the cells [Pa], shape (cells,)."""
        return np.asarray(nodal[self._cell_nodes].mean(axis=1))

    def commit(self, pressure: FloatArray) -> None:
        """Keep the pressures at the nodes [Pa], shape (nodes,), at the end of an accepted step."""
        self._last, self._committed = pressure.copy(), self.reference

    def saved(self) -> dict[str, Saved]:
        """Return the pressures after the last accepted step."""
        nodes = self._body.node_numbering
        return {
            "pressure": Saved(self._last, nodes),
            "reference_pressure": Saved(self._committed, nodes),
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore them."""
        self._last = arrays["pressure"].copy()
        self._committed = arrays["reference_pressure"].copy()
