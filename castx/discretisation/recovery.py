"""Values at the nodes from values in the cells, a linear function fitted round each node.

The middles of cells of low order are where stresses and fluxes are best; a linear function through
those of the cells round a node is an order better than the cells: O. C. Zienkiewicz, J. Z. Zhu, The
superconvergent patch recovery, International Journal for Numerical Methods in Engineering 33 (1992)
1331. Fits round the nodes inside serve the nodes at the surface too, where cells lie on one side
only. Cells that do not count, such as liquid ones, are as if they were not there, and no value
passes from body to body.
"""

from __future__ import annotations

import math

import numpy as np
from dolfinx.mesh import exterior_facet_indices
from scipy.sparse import csr_matrix

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.domain.measures import nodal_sum, nodes_on_facets
from castx.domain.mesh import BodyMesh

MOST_SWEEPS = 2
"""Layers of nodes at the surface that get their values from inside: a corner may have two."""
FLATTEST = 1e-3
"""Share of the largest moment of a patch below which it says nothing of a slope."""


class PatchRecovery:
    """Nodal values from cell values of a body.

    Args:
        body: its mesh.
        counting: whether each local cell counts, (cells,); None: all do.

    Attributes:
        cell_nodes: nodes of the owned cells, (owned cells, corners).
        counting: whether each owned cell counts.
    """

    def __init__(self, body: BodyMesh, counting: BoolArray | None = None) -> None:
        owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
        self._body, self.cell_nodes = body, body.nodes.dofmap.list[:owned]
        everything = np.ones(owned, dtype=bool)
        self.counting = everything if counting is None else counting[:owned]
        self._points = body.points
        corners = self._points[self.cell_nodes]
        sizes = np.ptp(corners, axis=1).max(axis=1)[:, None].repeat(corners.shape[1], axis=1)
        self._sizes = self._summed(sizes) / self._summed(np.ones_like(sizes))
        terms = self._of_place(self.cell_nodes, corners.mean(axis=1)[:, None])
        terms *= self.counting[:, None, None]
        self._gathering = self._to_nodes(terms)
        squares = terms[..., :, None] * terms[..., None, :]
        self._inverse = _inverses(self._summed(squares))
        missing = np.repeat(1.0 * ~self.counting[:, None], self.cell_nodes.shape[1], axis=1)
        outside = nodes_on_facets(body, exterior_facet_indices(body.mesh.topology))
        self._sweeps = self._levels(~outside & (self._summed(missing) == 0.0))

    def _levels(self, known: BoolArray) -> list[tuple[BoolArray, csr_matrix]]:
        """Return sweeps from the inside: the nodes reached, and what means them over fits."""
        found = []
        for _ in range(MOST_SWEEPS):
            usable = known[self.cell_nodes] & self.counting[:, None]
            reaching = np.repeat(usable.sum(axis=1)[:, None], usable.shape[1], axis=1)
            counts = self._summed(reaching.astype(np.float64))
            reached = ~known & (counts > 0.0)
            shares = np.where(reached, 1.0 / np.where(reached, counts, 1.0), 0.0)
            means = self._to_nodes(shares[self.cell_nodes]) @ self._to_nodes(1.0 * usable).T
            means.eliminate_zeros()
            found.append((reached, means))
            known = known | reached
        return found

    def _of_place(self, nodes: LongArray, places: FloatArray) -> FloatArray:
        """Return the terms 1, x, y … of fits round nodes at places, (…, terms)."""
        offsets = (places - self._points[nodes]) / self._sizes[nodes][..., None]
        return np.concatenate([np.ones((*offsets.shape[:-1], 1)), offsets], axis=-1)

    def _to_nodes(self, at_corners: FloatArray) -> csr_matrix:
        """Return the matrix that sums values of owned cells at their corners with weights.

        Args:
            at_corners: weights, (owned cells, corners) or (owned cells, corners, terms).

        Returns:
            Of shape (nodes × terms, owned cells).
        """
        cells, terms = len(self.cell_nodes), math.prod(at_corners.shape[2:])
        rows = self.cell_nodes[..., None] * terms + np.arange(terms)
        columns = np.broadcast_to(np.arange(cells)[:, None, None], rows.shape)
        shape = (len(self._points) * terms, cells)
        found = csr_matrix((at_corners.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
        found.eliminate_zeros()
        return found

    def _summed(self, at_corners: FloatArray) -> FloatArray:
        """Return sums over all ranks of values at the corners of owned cells, (nodes, …)."""
        here = np.zeros((len(self._points), *at_corners.shape[2:]))
        np.add.at(here, self.cell_nodes, at_corners)
        return nodal_sum(self._body, here)

    def at_nodes(self, values: FloatArray) -> FloatArray:
        """Return values at the local nodes, (nodes, components); collective.

        Args:
            values: in the local cells, (cells, components).
        """
        own = np.where(self.counting[:, None], values[: len(self.cell_nodes)], 0.0)
        shape = (*self._inverse.shape[:2], own.shape[1])
        sums = nodal_sum(self._body, (self._gathering @ own).reshape(shape))
        fits = self._inverse @ sums
        fits[:, 1:] /= self._sizes[:, None, None]
        # Each fit as a linear function of the place: its value at the origin, and its slopes.
        fits[:, 0] -= self._risen(fits)
        for reached, means in self._sweeps:
            here = means @ fits.reshape(shape[0], shape[1] * shape[2])
            mean = nodal_sum(self._body, here.reshape(shape))
            fits[reached] = mean[reached]
        return np.asarray(fits[:, 0] + self._risen(fits))

    def _risen(self, fits: FloatArray) -> FloatArray:
        """Return by what fits rise from the origin to their nodes, (nodes, components)."""
        return np.asarray(np.einsum("ni,nik->nk", self._points, fits[:, 1:]))


def _inverses(moments: FloatArray) -> FloatArray:
    """Return the inverses of the moments of patches, (nodes, terms, terms).

    A patch that says nothing of some slope gives the mean of its cells, without slopes.
    """
    values = np.linalg.eigvalsh(moments)
    enough = values[:, 0] > FLATTEST * values[:, -1]
    found = np.zeros_like(moments)
    found[enough] = np.linalg.inv(moments[enough])
    few = ~enough & (moments[:, 0, 0] > 0.0)
    found[few, 0, 0] = 1.0 / moments[few, 0, 0]
    return found
