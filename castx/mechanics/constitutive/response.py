"""Deviatoric stress and tangent at the integration points: solid, liquid, and mixture of both."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.materials.flow import FlowProperties
from castx.mechanics.constitutive.history import PointHistory, SolidStrain
from castx.mechanics.constitutive.law import Conditions
from castx.mechanics.constitutive.mush import Mush
from castx.mechanics.constitutive.return_mapping import (
    plastic_work,
    product,
    return_mapping,
    tensor_norm,
    viscoplastic_strain,
)

SMALLEST_SECANT = 1e-3
"""Least part of G to which plastic flow takes the secant modulus of the stabilisation."""


class Radial(NamedTuple):
    """Part b n ⊗ n of a tangent.

    Attributes:
        radial: b [Pa], shape (points,).
        direction: n, shape (points, components).
    """

    radial: FloatArray
    direction: FloatArray

    def along(self, change: FloatArray) -> FloatArray:
        """Return b n (n:de) [Pa] for changes of the strain, shape (points, components)."""
        return (self.radial * product(self.direction, change))[:, None] * self.direction


class Response(NamedTuple):
    """Deviatoric stress and tangent at the points: ds/de = isotropic I + Σ radial n ⊗ n.

    Attributes:
        stress: s [Pa], shape (points, components).
        isotropic: [Pa], shape (points,).
        radial: [Pa], shape (points,).
        direction: n, shape (points, components).
        elastic: elastic strain of the solid at the end of the step, shape (points, components).
        plastic: its viscoplastic strain, likewise.
        equivalent: its equivalent, shape (points,).
        work: plastic work per volume in the step [J/m³], shape (points,).
        mush: strains of the mush alone where solid is beside it; None: it has no past of its own.
        beside: part of the tangent by that mush, zero where there is none.
    """

    stress: FloatArray
    isotropic: FloatArray
    radial: FloatArray
    direction: FloatArray
    elastic: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    work: FloatArray
    mush: SolidStrain | None = None
    beside: Radial | None = None

    @property
    def strains(self) -> SolidStrain:
        """Strains of all that bears."""
        return SolidStrain(self.elastic, self.plastic, self.equivalent)

    @property
    def amounts(self) -> tuple[FloatArray, ...]:
        """All of which metals side by side have the mean."""
        return self.stress, self.isotropic, self.work, *self.strains

    def linear(self, change: FloatArray) -> FloatArray:
        """Return ds/de:de [Pa] for changes of the strain, shape (points, components)."""
        found = self.isotropic[:, None] * change
        found += Radial(self.radial, self.direction).along(change)
        return found if self.beside is None else found + self.beside.along(change)


def respond(conditions: Conditions, start: PointHistory, strain: FloatArray) -> Response:
    """Return the response to deviatoric strains at the end of the step, shape (points, components).

    Liquid: s = 2 (η/Δt) (e - e_n). Solid: s = 2 G E, by `return_mapping` if it flows. Where both
    are s = w s_solid + (1 - w) s_liquid.

    Raises:
        ConvergenceError: the flow rule of a point cannot be solved.
    """
    response = _solid_response(conditions, start, strain)
    share = conditions.shares.end
    if conditions.liquid_modulus is None and conditions.liquid_flow is None:
        return response
    if (share == 1.0).all():
        return response
    return _mixture(response, share, *_liquid_response(conditions, start, strain))


def foreseen(conditions: Conditions, start: PointHistory, strain: FloatArray) -> Response:
    """Return the response to the strains with which the iteration of a step begins.

    A point that has not moved yet resists the contraction of a whole step, and metal beside a front
    yields at once. The step will strain it by de^c or so: its stress and tangent are those of the
    law linear about e + de^c, its history is that of `respond`. Arguments and errors as there.
    """
    response, shape = respond(conditions, start, strain), conditions.shape
    still = ((strain == start.strain).all(axis=1) & shape.any(axis=1))[:, None]
    if conditions.flow is None or not still.any():
        return response
    there = respond(conditions, start, strain + shape)
    beside = None
    if response.beside is not None and there.beside is not None:
        beside = Radial(
            np.where(still[:, 0], there.beside.radial, response.beside.radial),
            np.where(still, there.beside.direction, response.beside.direction),
        )
    return response._replace(
        stress=np.where(still, there.stress - there.linear(shape), response.stress),
        isotropic=np.where(still[:, 0], there.isotropic, response.isotropic),
        radial=np.where(still[:, 0], there.radial, response.radial),
        direction=np.where(still, there.direction, response.direction),
        beside=beside,
    )


def _solid_response(conditions: Conditions, start: PointHistory, strain: FloatArray) -> Response:
    """Return the response of all that bears, of mush and solid each where a point holds both."""
    G, flow, shares, mush = (
        conditions.shear_modulus, conditions.flow, conditions.shares, conditions.mush
    )  # fmt: skip
    change = strain - start.strain
    if mush is None:
        step = _Stretch(G, flow, shares.carried, shares.strained, change - conditions.shape)
        return _flowed(step, start.mean)
    at, layers = mush.layers.points, mush.layers
    carried, strained, shape = (
        each.copy() for each in (shares.carried, shares.strained, conditions.shape)
    )
    carried[at], strained[at], shape[at] = 1.0, 1.0, mush.solid_shape
    of_solid, of_mush = mush.pasts(start)
    past = SolidStrain(*(mean.copy() for mean in start.mean))
    for all_points, some in zip(past, of_solid, strict=True):
        all_points[at] = some
    main = _flowed(_Stretch(G, flow, carried, strained, change - shape), past)
    step = _Stretch(
        G[at], mush.flow, layers.shares.carried, layers.shares.strained, change[at] - mush.shape
    )
    return _beside(main, _flowed(step, of_mush), mush, shares.end[at])


class _Stretch(NamedTuple):
    """Stretch of metal that bears in a step, and what meets it.

    Attributes:
        shear_modulus: G [Pa], shape (points,).
        flow: None: elastic.
        carried: part of it that was there at the start, shape (points,).
        strained: part of the strain that it has seen, likewise.
        stretched: de - de^c, shape (points, components).
    """

    shear_modulus: FloatArray
    flow: FlowProperties | None
    carried: FloatArray
    strained: FloatArray
    stretched: FloatArray


def _flowed(step: _Stretch, past: SolidStrain) -> Response:
    """Return the response of metal with a past to a step."""
    G, strained = step.shear_modulus, step.strained
    carried = step.carried[:, None]
    elastic = carried * past.elastic + strained[:, None] * step.stretched
    plastic, equivalent = carried * past.plastic, step.carried * past.equivalent
    trial = (2 * G)[:, None] * elastic
    none = np.zeros(len(G))
    if step.flow is None:
        return Response(
            trial, 2 * G * strained, none, np.zeros_like(trial), elastic, plastic, equivalent, none
        )
    back = (2 / 3 * step.flow.kinematic_modulus)[:, None] * plastic
    returned = return_mapping(trial, back, equivalent, step.flow)
    flowed = viscoplastic_strain(returned)
    return Response(
        returned.stress, returned.isotropic * strained, returned.radial * strained,
        returned.direction, elastic - flowed, plastic + flowed, equivalent + returned.increment,
        plastic_work(returned),
    )  # fmt: skip


def _beside(main: Response, mush: Response, held: Mush, share: FloatArray) -> Response:
    """Return the means of solid and mush at the points that hold both.

    Args:
        main: response of all points, with the solid alone at those.
        mush: of the mush there.
        held: solid and mush of the step.
        share: w of all that bears there, shape (such points,).
    """
    at = held.layers.points
    a, b = held.layers.solid / share, held.layers.shares.end / share
    alone = SolidStrain(*(each.copy() for each in main.strains))
    for every, here in zip(alone, mush.strains, strict=True):
        every[at] = here
    beside = Radial(np.zeros_like(main.radial), np.zeros_like(main.direction))
    beside.radial[at], beside.direction[at] = b * mush.radial, mush.direction
    main.radial[at] *= a
    for mean, here in zip(main.amounts, mush.amounts, strict=True):
        mean[at] = (a * mean[at].T + b * here.T).T
    return main._replace(mush=alone, beside=beside)


def _liquid_response(
    conditions: Conditions, start: PointHistory, strain: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    change = strain - start.strain
    modulus, flow = conditions.liquid_modulus, conditions.liquid_flow
    if flow is None:
        assert modulus is not None
        none = np.zeros(len(modulus))
        return (2 * modulus)[:, None] * change, 2 * modulus, none, np.zeros_like(change)
    trial = (2 * conditions.shear_modulus)[:, None] * change
    returned = return_mapping(trial, np.zeros_like(trial), np.zeros(len(trial)), flow)
    return returned.stress, returned.isotropic, returned.radial, returned.direction


def _mixture(
    solid: Response,
    share: FloatArray,
    stress: FloatArray,
    isotropic: FloatArray,
    radial: FloatArray,
    direction: FloatArray,
) -> Response:
    w, rest = share[:, None], (1 - share)[:, None]
    # Trial stresses of both phases differ where the solid has a past. The tangent of a mixture
    # keeps the direction of the phase that bears more of the radial part.
    use_solid = share * np.abs(solid.radial) >= (1 - share) * np.abs(radial)
    return solid._replace(
        stress=w * solid.stress + rest * stress,
        isotropic=share * solid.isotropic + (1 - share) * isotropic,
        radial=np.where(use_solid, share * solid.radial, (1 - share) * radial),
        direction=np.where(use_solid[:, None], solid.direction, direction),
        work=share * solid.work,
        beside=solid.beside and solid.beside._replace(radial=share * solid.beside.radial),
    )


def secant_softening(
    response: Response, conditions: Conditions, start: PointHistory, strain: FloatArray
) -> FloatArray:
    """Return ‖s‖/(2 G ‖E + e_vp‖), the secant modulus over the elastic one, shape (points,).

    In a liquid E + e_vp is the strain of the step. The stabilisation τ of the next step takes G
    times this factor, see `forms/stabilisation`.
    """
    solid = conditions.shares.end > 0
    stretch = np.where(solid[:, None], response.elastic + response.plastic, strain - start.strain)
    elastic = 2 * conditions.shear_modulus * tensor_norm(stretch)
    of_solid = 2 * conditions.shear_modulus * tensor_norm(response.elastic)
    stress = np.where(solid, of_solid, tensor_norm(response.stress))
    found = np.divide(stress, elastic, out=np.ones_like(elastic), where=elastic > 0)
    return np.asarray(np.clip(found, SMALLEST_SECANT, 1.0))
