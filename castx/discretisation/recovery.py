"""Values at the nodes from values in the cells, a linear function fitted round each node.

The middles of cells of low order are where stresses and fluxes are best; a linear function through
those of the cells round a node is an order better than the cells: O. C. Zienkiewicz, J. Z. Zhu, The
superconvergent patch recovery, International Journal for Numerical Methods in Engineering 33 (1992)
1331. Fits round the nodes inside serve the nodes at the surface too, where cells lie on one side
only. Cells that do not count, such as liquid ones, are as if they were not there, and no value
passes from body to body.
"""

from __future__ import annotations

import numpy as np
from dolfinx.mesh import exterior_facet_indices

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
        self._nodes, gdim = len(body.parent_vertices), body.mesh.geometry.dim
        corners = body.points[self.cell_nodes]
        sizes = np.ptp(corners, axis=1).max(axis=1)[:, None].repeat(corners.shape[1], axis=1)
        self._sizes = self._summed(sizes) / self._summed(np.ones_like(sizes))
        self._points = body.points
        self._terms = self._of_place(self.cell_nodes, corners.mean(axis=1)[:, None])
        self._terms *= self.counting[:, None, None]
        moments = np.empty((self._nodes, gdim + 1, gdim + 1))
        for i, j in np.ndindex(gdim + 1, gdim + 1):
            moments[:, i, j] = self._summed(self._terms[:, :, i] * self._terms[:, :, j])
        self._inverse = _inverses(moments)
        missing = np.repeat(1.0 * ~self.counting[:, None], self.cell_nodes.shape[1], axis=1)
        outside = nodes_on_facets(body, exterior_facet_indices(body.mesh.topology))
        self._sweeps = self._levels(~outside & (self._summed(missing) == 0.0))

    def _levels(self, known: BoolArray) -> list[tuple[BoolArray, BoolArray, FloatArray]]:
        """Return sweeps from the inside: nodes known before, those reached, by how many corners."""
        found = []
        for _ in range(MOST_SWEEPS):
            usable = known[self.cell_nodes] & self.counting[:, None]
            reaching = np.repeat(usable.sum(axis=1)[:, None], usable.shape[1], axis=1)
            counts = self._summed(reaching.astype(np.float64))
            reached = ~known & (counts > 0.0)
            found.append((known, reached, np.where(reached, counts, 1.0)))
            known = known | reached
        return found

    def _of_place(self, nodes: LongArray, places: FloatArray) -> FloatArray:
        """Return the terms 1, x, y … of fits round nodes at places, (…, terms)."""
        offsets = (places - self._points[nodes]) / self._sizes[nodes][..., None]
        return np.concatenate([np.ones((*offsets.shape[:-1], 1)), offsets], axis=-1)

    def _summed(self, at_corners: FloatArray) -> FloatArray:
        """Return sums over all ranks of values at the corners of owned cells, (nodes,)."""
        here = np.bincount(self.cell_nodes.ravel(), at_corners.ravel(), self._nodes)
        return nodal_sum(self._body, here)

    def at_nodes(self, values: FloatArray) -> FloatArray:
        """Return values at the local nodes, (nodes, components); collective.

        Args:
            values: in the local cells, (cells, components).
        """
        own = np.where(self.counting[:, None], values[: len(self.cell_nodes)], 0.0)
        terms, components = self._terms.shape[2], own.shape[1]
        sums = np.empty((self._nodes, terms, components))
        for i, k in np.ndindex(terms, components):
            sums[:, i, k] = self._summed(self._terms[:, :, i] * own[:, k, None])
        fits = np.einsum("nij,njk->nik", self._inverse, sums)
        fits[:, 1:] /= self._sizes[:, None, None]
        for known, reached, counts in self._sweeps:
            fits = self._extended(fits, known, reached, counts)
        return np.asarray(fits[:, 0])

    def _extended(
        self, fits: FloatArray, known: BoolArray, reached: BoolArray, counts: FloatArray
    ) -> FloatArray:
        """Return fits in which some nodes have the means of those of the cells round them.

        Args:
            fits: values and slopes at the nodes, (nodes, terms, components).
            known: which of them are used.
            reached: nodes that get a mean.
            counts: number of fits in it, (nodes,).
        """
        nodes = self.cell_nodes
        usable = known[nodes] & self.counting[:, None]
        slopes = np.where(usable[..., None, None], fits[nodes, 1:], 0.0)
        # Each fit as a linear function of the place: its value at the origin, and its slopes.
        offsets = np.einsum("cai,caik->cak", self._points[nodes], slopes)
        values = np.where(usable[..., None], fits[nodes, 0], 0.0) - offsets
        origin, slope = values.sum(axis=1), slopes.sum(axis=1)
        found = fits.copy()
        places = self._points[nodes]
        for k in range(fits.shape[2]):
            at_corners = origin[:, None, k] + np.einsum("cai,ci->ca", places, slope[..., k])
            parts = [at_corners, *(np.broadcast_to(one[:, None], nodes.shape)
                                   for one in slope[..., k].T)]  # fmt: skip
            for term, part in enumerate(parts):
                mean = self._summed(part) / counts
                found[reached, term, k] = mean[reached]
        return found


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
