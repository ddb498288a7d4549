"""Solid that grows inside a cell: its share, its contraction, and the volume of the cell.

A front passes through the cells, so that solid grows in increments. With w the share of a point
that bears stress, e the deviatoric and θ = ∇·u the volumetric strain,

    ds = w 2G (de − de_vp),   dθ = w dp/K + de^θ,

and solid that is new is born free of stress, under the pressure that acts. The share stands at the
nodes, where the solid fraction f_s does, w = w(f_s) (`Material.bearing_share`), and so does the
strain of contraction c, thermal and of solidification. A cell contracts where it is solid, by its
corners v, or by samples inside where its mush ends (`places`): all of its solid together by
da = Σ_v w_v dc_v / Σ_v w_v, its volume by the mean of dc_v (`eigenstrain`). What cooled before it
bears does not count: between no solid and some, dc begins with c_b, that of a place as it begins to
bear. Solid grows while it contracts, in a thin skin by much of what there is: the sum over a step
goes through the states that its heat has passed (`growth`).

Over one step, with w_0 and w the shares at its start and its end,

    E = (min(w_0, w) E_n + w_m (de − de^c))/w,   da = ∫ Σ_v w_v dc_v / Σ_v w_m,v,

are the mean elastic strain of the solid before it flows, and its contraction: the strain of the
start is diluted by what is born, de^c is the part without stress, and w_m is the share that was
there to be strained while the body contracted, w where nothing grows,

    w_m = ∫ w |dε| / ∫ |dε|,   dε = ∫ w dc dV / ∫ w dV.

A change of the pressure meets the same share, dθ = w_m dp/K + de^θ: solid that is born late in a
step has seen little of it. What melts takes its stress away with it.

A plateau of an alloy, freezing at one temperature, passes through a node as a front: the share
rises there from w_a ahead of it to w_b behind it in no length, while the mean w of the node creeps
from one to the other. Its solidification contracts the solid at (w_a + w_b)/2 throughout.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints, part_of_whole
from castx.mechanics.constitutive.places import MetalPlaces

ROUNDING = 1e-15
"""Strain of contraction over a step that is none."""


class MetalNodes(NamedTuple):
    """Metal of the nodes, or of other places, at one time.

    Attributes:
        share: w, the share that bears stress, shape (nodes,).
        contraction: c, volumetric strain of temperature and solidification, shape (nodes,).
        temperature: T [°C], shape (nodes,).
    """

    share: FloatArray
    contraction: FloatArray
    temperature: FloatArray


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
        carried, strained = (part_of_whole(part, end) for part in parts)
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
        self,
        start: FloatArray,
        end: FloatArray,
        strained: FloatArray,
        compressibility: FloatArray,
        change: FloatArray,
    ) -> FloatArray:
        """Return E in the next step, shape (cells,).

        New solid is born at the volume that the cell has, and under its pressure, so that neither
        changes by its birth. In the step θ = w_m p/K + E, with

            E = (w_0/w) E_n + (1 − w_0/w)(θ_n − w_0 p_n/K) + de^θ − (w_m − w_0) p_n/K,

        and what melts leaves its volume in the cell. Of liquid, E_n is what `forgotten` leaves.

        Args:
            start: w_0 of the cells, shape (cells,).
            end: w of the cells, shape (cells,).
            strained: w_m of the cells, shape (cells,).
            compressibility: 1/K of the solid [1/Pa], shape (cells,).
            change: de^θ, shape (cells,).
        """
        seen = (strained - start) * compressibility * self.mean_stress
        return np.asarray(self.free + self.born(start, end, compressibility) + change - seen)

    def born(self, start: FloatArray, end: FloatArray, compressibility: FloatArray) -> FloatArray:
        """Return the change of E by solid that is born at the volume of its cell, (volumes,).

        (1 − w_0/w)(θ_n − w_0 p_n/K − E_n), which elements with a pressure of their own leave zero.
        Others share theirs, so that cells beside a front have less volume than they should, and
        the liquid that they lack is in others.

        Args:
            start: w_0, shape (volumes,).
            end: w, likewise.
            compressibility: 1/K of the solid [1/Pa], likewise.
        """
        new = np.divide(end - start, end, out=np.zeros_like(end), where=end > start)
        off = self.dilatation - start * compressibility * self.mean_stress - self.free
        return np.asarray(new * off)


class Growth(NamedTuple):
    """Solid of the nodes, or of other places, over a step, each of shape (places,).

    All the solid of a cell contracts by da = ∫ Σ_v w_v dc_v / Σ_v w_m,v over its corners.

    Attributes:
        strained: w_m, the mean of w while the body contracts.
        weighted: ∫ w dc.
        contracted: ∫ dc of what bears.
    """

    strained: FloatArray
    weighted: FloatArray
    contracted: FloatArray

    def along(self, places: IntegrationPoints | MetalPlaces) -> FloatArray:
        """Return da, the contraction of all the solid along a front, shape (volumes,)."""
        return part_of_whole(places.volume_means(self.weighted), places.volume_means(self.strained))

    def across(self, places: IntegrationPoints | MetalPlaces) -> FloatArray:
        """Return the mean of ∫ dc_v, the contraction of the volumes, shape (volumes,)."""
        return places.volume_means(self.contracted)


class Freezing(NamedTuple):
    """Contraction of the nodes, or of other places, as they freeze, each of shape (places,).

    Attributes:
        born: c_b, c as they begin to bear.
        frozen: c as they become solid.
    """

    born: FloatArray
    frozen: FloatArray

    def of_mush(self, metal: MetalNodes) -> FloatArray:
        """Return c while some of the metal bears, held beyond both ends, shape (places,)."""
        started = np.where(metal.share > 0, metal.contraction, self.born)
        return np.where(metal.share < 1, started, self.frozen)

    def of_solid(self, metal: MetalNodes) -> FloatArray:
        """Return c of the metal since it became solid, zero before, shape (places,)."""
        return np.where(metal.share < 1, 0.0, metal.contraction - self.frozen)


def growth(
    places: IntegrationPoints | MetalPlaces,
    passed: Sequence[MetalNodes],
    freezing: Freezing,
    *,
    isothermal: bool = False,
    fronts: Sequence[PlateauFront] = (),
) -> Growth:
    """Return growth and contraction of the solid between the states of a step; collective.

    What is solid throughout contracts while other metal freezes beside it, w = (w_a + w_b)/2
    between states a and b; so does mush. Metal that becomes solid contracts after that, w = w_b.
    What strains by that is the same share, but behind the front of metal that freezes at one
    temperature (`_share_behind_a_front`).

    A skin strains as a whole: how far it has come at a time within the step is taken from the mean
    over the body. Nodes that freeze one after the other contract by fits and starts.

    Args:
        places: of the metal; integration points stand for the nodes of the body.
        passed: metal of the nodes at the start of the step, between, and at its end, in equal
            times.
        freezing: contraction of the nodes as they begin to bear and become solid.
        isothermal: whether the metal freezes at one temperature.
        fronts: plateaus of an alloy whose solidification contracts the skeleton.
    """
    phases = [
        phase
        for before, after in pairwise(passed)
        for phase in _phases(before, after, freezing, fronts, isothermal=isothermal)
    ]
    amounts = [phase.weighted for phase in phases]
    part, whole = places.integrals(
        [*(np.abs(amount) for amount in amounts), *(phase.strained for phase in phases)]
    ).reshape(2, -1)
    strains = np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)
    if not np.any(strains > ROUNDING):
        strains = np.tile([1.0, 0.0, 0.0], len(passed) - 1)
    strained = sum(strain * phase.strained for strain, phase in zip(strains, phases, strict=True))
    contracted = sum(phase.contracted for phase in phases)
    return Growth(
        np.asarray(strained / strains.sum()), np.asarray(sum(amounts)), np.asarray(contracted)
    )


class PlateauFront(NamedTuple):
    """Part of an alloy that freezes at one temperature, behind a front without a length.

    It contracts while it passes from w_a to w_b, so that ∫ w dc = Δc (w_a + w_b)/2.

    Attributes:
        begin: w_a, ahead of it.
        end: w_b, behind it.
        contraction: dc/dw between them.
    """

    begin: float
    end: float
    contraction: float

    def beyond_mean(self, before: FloatArray, after: FloatArray) -> FloatArray:
        """Return ∫ w dc of the front less that at the mean share of the nodes, shape (nodes,).

        Args:
            before: w of the nodes, shape (nodes,).
            after: later, likewise.
        """
        first, last = (np.clip(share, self.begin, self.end) for share in (before, after))
        there = 0.5 * (self.begin + self.end) - 0.5 * (first + last)
        return np.asarray(self.contraction * (last - first) * there)


class _Phase(NamedTuple):
    """Contraction of one kind of metal between two states, each of shape (nodes,).

    Attributes:
        contracted: ∫ dc of this metal.
        weighted: ∫ w dc of it.
        strained: w of the nodes meanwhile.
    """

    contracted: FloatArray
    weighted: FloatArray
    strained: FloatArray


def _phases(
    before: MetalNodes,
    after: MetalNodes,
    freezing: Freezing,
    fronts: Sequence[PlateauFront],
    *,
    isothermal: bool,
) -> tuple[_Phase, _Phase, _Phase]:
    """Return the phases of solid that stays, of mush, and of new solid behind its birth."""
    mean, most = 0.5 * (before.share + after.share), np.maximum(before.share, after.share)
    cooled = freezing.of_solid(after) - freezing.of_solid(before)
    solid = (before.share == 1) & (after.share == 1)
    behind = _share_behind_a_front(before.share, after.share) if isothermal else mean
    mush = freezing.of_mush(after) - freezing.of_mush(before)
    beyond = sum(front.beyond_mean(before.share, after.share) for front in fronts)
    stays, becomes = np.where(solid, cooled, 0.0), np.where(solid, 0.0, cooled)
    return (
        _Phase(stays, most * stays, behind),
        _Phase(mush, mean * mush + beyond, mean),
        _Phase(becomes, most * becomes, most),
    )


def _share_behind_a_front(before: FloatArray, after: FloatArray) -> FloatArray:
    """Return w that belongs to the temperatures which an implicit Euler step ends with.

    Over a step Δt the latent heat of all that freezes leaves the metal evenly, so that a front at
    X' t brings to what is solid behind it, quasi-steady, the temperatures of X' (t − Δt/2). Between
    two steps they cool by what belongs to X' (t − Δt): the share of the start, and a quarter of
    what freezes in the first step of all, since X² grows evenly from none.
    """
    return np.where(after > before, np.maximum(before, 0.25 * after), 0.5 * (before + after))


def in_the_solid(points: IntegrationPoints, values: FloatArray, weight: FloatArray) -> FloatArray:
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
