"""Mush beside solid in one point: two metals that strain alike, each with a past of its own.

Mush that bears shrinks by its solidification, often by ten times the strain at which it yields, and
the solid behind it by its temperature alone. A layer that yields pulls by its yield stress, however
much it shrinks: where it is thin beside the skin, the skin stays. A cell with one stress for both
would shrink as a whole, by their mean.

Of the share w that bears at a point let w_s be solid throughout a step, and w_u all other metal,
which is mush at its start or at its end. Then

    s = (w_s s_s + w_u s_u)/w,

and each of both grows and flows by the law of `growth` with its own shares and temperature. With
da_s and da_u the contractions along the front and da that of all, w_m da = w_s da_s + w_m,u da_u,

    de^c_u = de^c + λ (da_u − da)/3 (1 − 3 n ⊗ n),    λ = (1 + ν)/(3 (1 − ν)),

and de^c_s likewise. In the stress of a cell both have one pressure. Layers behind each other bear
no stress across the front, each for itself, so that a difference δ of their lateral strains is met
by the deviator 2 G λ δ. Shares, temperatures and λ alone tell both from one metal: while neither
flows, their mean is its stress. Mush that has become solid takes along what it bears,
w E = w_s E_s + w_u E_u, and so does solid that melts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.materials.flow import FlowProperties
from castx.mechanics.constitutive.growth import Growth, MetalNodes, Shares
from castx.mechanics.constitutive.history import PointHistory, SolidStrain
from castx.mechanics.constitutive.integration_points import part_of_whole
from castx.mechanics.constitutive.places import MetalPlaces


class Layers(NamedTuple):
    """Solid and mush of the points that hold both in a step, each of shape (such points,).

    Attributes:
        points: indices of these points.
        solid: w_s, the share that is solid throughout.
        solid_before: share that was solid at the start, with what melts in the step.
        mush_before: share that was mush at the start.
        shares: of all metal but w_s.
        solid_excess: da_s − da.
        mush_excess: da_u − da.
        solid_temperature: [°C].
        mush_temperature: [°C].
    """

    points: LongArray
    solid: FloatArray
    solid_before: FloatArray
    mush_before: FloatArray
    shares: Shares
    solid_excess: FloatArray
    mush_excess: FloatArray
    solid_temperature: FloatArray
    mush_temperature: FloatArray


class Mush(NamedTuple):
    """Layers of a step with the coefficients of their laws.

    Attributes:
        layers: solid and mush of the points that hold both.
        flow: of the mush, at these points.
        solid_shape: de^c of the solid, shape (such points, components).
        shape: de^c of the mush, likewise.
    """

    layers: Layers
    flow: FlowProperties
    solid_shape: FloatArray
    shape: FloatArray

    def pasts(self, start: PointHistory) -> tuple[SolidStrain, SolidStrain]:
        """Return the strains of solid and of mush with which a step starts, at these points.

        Args:
            start: history at the start of the step, of all points.
        """
        layers, at = self.layers, self.layers.points
        melted = layers.solid_before - layers.solid
        whole = layers.solid_before + layers.mush_before
        part = part_of_whole(melted, melted + layers.mush_before)
        solids, mushes = [], []
        for mean, mush in zip(start.mean, start.of_mush, strict=True):
            of_mush = mush[at]
            off = _by_rows(whole / layers.solid_before, mean[at] - of_mush)
            solids.append(of_mush + off)
            mushes.append(of_mush + _by_rows(part, off))
        return SolidStrain(*solids), SolidStrain(*mushes)


def layers_of(
    places: MetalPlaces, start: MetalNodes, end: MetalNodes, grown: Growth, shares: Shares
) -> Layers:
    """Return solid and mush of the points that hold both in a step.

    Args:
        places: of the metal.
        start: metal of the places at the start of the step.
        end: at its end.
        grown: growth of the solid between.
        shares: of all that bears at the points.
    """
    was_solid = start.share == 1
    stays = was_solid & (end.share == 1)
    at_points = places.at_points
    solid = at_points(stays * 1.0)
    both = np.flatnonzero((solid > 0) & ((shares.start > solid) | (shares.end > solid)))

    def of_solid(values: FloatArray) -> FloatArray:
        """Return the part of what is solid throughout in means at the points that hold both."""
        return at_points(np.where(stays, values, 0.0))[both]

    def of_mush(values: FloatArray) -> FloatArray:
        """Return the part of all other metal, likewise."""
        return at_points(np.where(stays, 0.0, values))[both]

    solid, last, strained = solid[both], of_mush(end.share), of_mush(grown.strained)
    weighted, solid_weighted = of_mush(grown.weighted), of_solid(grown.weighted)
    heat = end.share * end.temperature
    along = (solid_weighted + weighted) / (solid + strained)
    warmth = of_solid(heat) / solid
    return Layers(
        both, solid, at_points(was_solid * 1.0)[both],
        at_points(np.where(was_solid, 0.0, start.share))[both],
        Shares.between(of_mush(start.share), last, strained), solid_weighted / solid - along,
        np.where(strained > 0, part_of_whole(weighted, strained) - along, 0.0),
        warmth, np.where(last > 0, part_of_whole(of_mush(heat), last), warmth),
    )  # fmt: skip


def across_one_layer(poisson_ratio: FloatArray) -> FloatArray:
    """Return λ = (1 + ν)/(3 (1 − ν)), by which a layer without stress across it bears less.

    Args:
        poisson_ratio: ν, shape (points,).
    """
    return (1 + poisson_ratio) / (3 * (1 - poisson_ratio))


def _by_rows(factor: FloatArray, values: FloatArray) -> FloatArray:
    """Return numbers or tensors of the points times a factor of each."""
    return np.asarray((values.T * factor).T)
