"""Solid that grows inside a cell: its share, its contraction, and the volume of the cell.

A front passes through the cells, so that solid grows in increments. With w the share of a point
that bears stress, e the deviatoric and θ = ∇·u the volumetric strain,

    ds = w 2G (de − de_vp),   dθ = w dp/K + de^θ,

and solid that is new is born free of stress, under the pressure that acts. The share stands at the
nodes, where the solid fraction f_s does, w = w(f_s) (`Material.bearing_share`), and so does the
strain of contraction c, thermal and of solidification. A cell contracts where it is solid,

    de^θ = Σ_v w_v dc_v / Σ_v w_v,

over its corners v. Solid grows while it contracts, in a thin skin by much of what there is: the sum
over a step goes through the states that its heat has passed (`contraction`).

Over one step, with w_0 and w the shares at its start and its end,

    E = (min(w_0, w) E_n + w_m de)/w,   w_m = ∫ w |de^θ| / ∫ |de^θ| where solid grows, else w,

is the mean elastic strain of the solid before it flows: that of the start is diluted by what is
born, and w_m is the share that was there to be strained while the cell contracted. What melts takes
its stress away with it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
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
    def between(cls, start: FloatArray, end: FloatArray, mean: FloatArray) -> Shares:
        """Return the shares of points with w_0, w and the mean in between, shape (points,)."""
        parts = np.minimum(start, end), np.minimum(mean, end)
        solid = end > 0
        carried, strained = (
            np.divide(part, end, out=np.zeros_like(end), where=solid) for part in parts
        )
        return cls(start, end, carried, strained)


class CellVolume(NamedTuple):
    """Volume of the cells, or of the points, at the end of a step, each of shape (volumes,).

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

    def mapped(self, change: Callable[[FloatArray], FloatArray]) -> CellVolume:
        """Return the volume with each of its arrays changed by a function."""
        return CellVolume(*(change(values) for values in self))

    def grown(
        self, start: FloatArray, end: FloatArray, compressibility: FloatArray, change: FloatArray
    ) -> FloatArray:
        """Return E at the end of the next step, shape (cells,).

        New solid is born at the volume that the cell has, and under its pressure, so that neither
        changes by its birth:

            E = (w_0/w) E_n + (1 − w_0/w)(θ_n − w_0 p_n/K) + de^θ − (w − w_0) p_n/K,

        and what melts leaves its volume in the cell. Without any solid E_n is θ_n.

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


class Contraction(NamedTuple):
    """Contraction over a step.

    Attributes:
        cells: de^θ of the cells, shape (cells,).
        share: w_m of the points, the mean of w while their cell contracted, shape (points,).
    """

    cells: FloatArray
    share: FloatArray


def contraction(
    points: IntegrationPoints, passed: Sequence[MetalNodes], frozen: FloatArray
) -> Contraction:
    """Return the sum of Σ w_v dc_v/Σ w_v between the states that a step has passed.

    What is solid throughout contracts while other metal freezes beside it, w = (w_a + w_b)/2
    between states a and b; so does mush. Metal that becomes solid contracts after that, w = w_b.

    Args:
        points: integration points of the body.
        passed: metal of the nodes at the start of the step, between, and at its end.
        frozen: c of the nodes as they become solid, shape (nodes,).
    """
    cells = np.zeros(points.volumes)
    weighted, weight, plain = np.zeros((3, points.count))
    for before, after in pairwise(passed):
        mean, most = 0.5 * (before.share + after.share), np.maximum(before.share, after.share)
        plain += points.from_nodes(mean) / (len(passed) - 1)
        begun, ended = (
            np.where(state.share < 1, state.contraction, frozen) for state in (before, after)
        )
        cooled = after.contraction - ended - (before.contraction - begun)
        solid = (before.share == 1) & (after.share == 1)
        for change, share in (
            (ended - begun + np.where(solid, cooled, 0.0), mean),
            (np.where(solid, 0.0, cooled), most),
        ):
            part = points.volume_means(change, share)
            cells += part
            size = points.from_volumes(np.abs(part))
            weighted += size * points.from_nodes(share)
            weight += size
    share = np.divide(weighted, weight, out=plain, where=weight > 0)
    return Contraction(cells, share)


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
