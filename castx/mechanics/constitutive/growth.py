"""Solid that grows inside a cell: its share, its contraction, and the volume of the cell.

A front passes through the cells, so that solid grows in increments. With w the share of a point
that bears stress, e the deviatoric and θ = ∇·u the volumetric strain,

    ds = w 2G (de − de_vp),   dθ = w dp/K + de^θ,

and solid that is new is born free of stress, under the pressure that acts. The share stands at the
nodes, where the solid fraction f_s does, w = w(f_s) (`Material.bearing_share`), and so does the
strain of contraction c, thermal and of solidification. A cell contracts where it is solid,

    de^θ = Σ_v W_v dc_v / Σ_v W_v,   W_v = max(w_v, w_v at the start),

over its corners v. Over one step, with w_0 and w the shares at its start and its end,

    E = (min(w_0, w) E_n + w_m de)/w,   w_m = (w_0 + w)/2 where solid grows, else w,

is the mean elastic strain of the solid before it flows: that of the start is diluted by what is
born, and that has been strained for half of the step. What melts takes its stress away with it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints


class MetalNodes(NamedTuple):
    """Metal of the nodes at one time.

    Attributes:
        share: w, the share that bears stress, shape (nodes,).
        contraction: c, volumetric strain of temperature and solidification, shape (nodes,).
    """

    share: FloatArray
    contraction: FloatArray


class Shares(NamedTuple):
    """Solid at the points, at the end of a step and since its start, each of shape (points,).

    Attributes:
        start: w_0.
        end: w.
        carried: min(w_0, w)/w, the part of the solid that was there at the start; 0 without any.
        strained: w_m/w, the part of the strain of the step that the solid has seen, likewise.
    """

    start: FloatArray
    end: FloatArray
    carried: FloatArray
    strained: FloatArray

    @classmethod
    def between(cls, start: FloatArray, end: FloatArray) -> Shares:
        """Return the shares of points with w_0 and w, shape (points,)."""
        mean = np.where(end > start, 0.5 * (start + end), end)
        parts = np.minimum(start, end), mean
        solid = end > 0
        carried, strained = (
            np.divide(part, end, out=np.zeros_like(end), where=solid) for part in parts
        )
        return cls(start, end, carried, strained)


class CellVolume(NamedTuple):
    """Volume of the cells at the end of a step, each of shape (cells,).

    Attributes:
        free: E in θ = w p/K + E, the volumetric strain without pressure.
        dilatation: θ.
        mean_stress: p [Pa].
        contracted: sum of all de^θ.
    """

    free: FloatArray
    dilatation: FloatArray
    mean_stress: FloatArray
    contracted: FloatArray

    def grown(
        self, start: FloatArray, end: FloatArray, compressibility: FloatArray, change: FloatArray
    ) -> FloatArray:
        """Return E at the end of the next step, shape (cells,).

        New solid is born at the volume that the cell has, and under its pressure, so that neither
        changes by its birth:

            E = (w_0/w) E_n + (1 − w_0/w)(θ_n − w_0 p_n/K) + de^θ − (w − w_0) p_n/K,

        and what melts leaves its volume in the cell.

        Args:
            start: w_0 of the cells, shape (cells,).
            end: w of the cells, shape (cells,).
            compressibility: 1/K of the solid [1/Pa], shape (cells,).
            change: de^θ, shape (cells,).
        """
        elastic = compressibility * self.mean_stress
        old = np.divide(start, end, out=np.ones_like(end), where=end > start)
        born = self.dilatation - start * elastic
        return np.asarray(old * self.free + (1 - old) * born + change - (end - start) * elastic)


def contraction(points: IntegrationPoints, start: MetalNodes, end: MetalNodes) -> FloatArray:
    """Return de^θ = Σ W_v dc_v/Σ W_v of the cells over a step, shape (cells,)."""
    weight = np.maximum(start.share, end.share)
    return weighted_means(points, end.contraction - start.contraction, weight)


def weighted_means(
    points: IntegrationPoints, values: FloatArray, weight: FloatArray
) -> FloatArray:
    """Return Σ W_v a_v/Σ W_v over the corners of the cells, zero without any W, shape (cells,).

    Args:
        points: integration points of the body.
        values: a_v of the nodes, shape (nodes,).
        weight: W_v of the nodes, shape (nodes,).
    """
    corners = points.cell_nodes
    total = weight[corners].sum(axis=1)
    weighted = (weight * values)[corners].sum(axis=1)
    return np.asarray(np.divide(weighted, total, out=np.zeros_like(total), where=total > 0))


def in_the_solid(
    points: IntegrationPoints, values: FloatArray, weight: FloatArray
) -> FloatArray:
    """Return nodal values at the points as means over the solid there, shape (points,).

    Args:
        points: integration points of the body.
        values: of the nodes, shape (nodes,).
        weight: share of the solid at the nodes, shape (nodes,); plain values where there is none.
    """
    total = points.from_nodes(weight)
    plain = points.from_nodes(values)
    weighted = points.from_nodes(weight * values)
    partly = (total > 0) & (total < 1)
    return np.asarray(np.divide(weighted, total, out=plain, where=partly))
