"""Deviatoric stress and tangent at the integration points: solid, liquid, and mixture of both."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import Conditions
from castx.mechanics.constitutive.return_mapping import (
    plastic_work,
    product,
    return_mapping,
    tensor_norm,
    viscoplastic_strain,
)

SMALLEST_SECANT = 1e-3
"""Least part of G to which plastic flow takes the secant modulus of the stabilisation."""


class Response(NamedTuple):
    """Deviatoric stress and tangent at the points: ds/de = isotropic I + radial n ⊗ n.

    Attributes:
        stress: s [Pa], shape (points, components).
        isotropic: [Pa], shape (points,).
        radial: [Pa], shape (points,).
        direction: n, shape (points, components).
        elastic: elastic strain of the solid at the end of the step, shape (points, components).
        plastic: its viscoplastic strain, likewise.
        equivalent: its equivalent, shape (points,).
        work: plastic work per volume in the step [J/m³], shape (points,).
    """

    stress: FloatArray
    isotropic: FloatArray
    radial: FloatArray
    direction: FloatArray
    elastic: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    work: FloatArray


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
    change = there.isotropic[:, None] * shape
    change += (there.radial * product(there.direction, shape))[:, None] * there.direction
    return response._replace(
        stress=np.where(still, there.stress - change, response.stress),
        isotropic=np.where(still[:, 0], there.isotropic, response.isotropic),
        radial=np.where(still[:, 0], there.radial, response.radial),
        direction=np.where(still, there.direction, response.direction),
    )


def _solid_response(conditions: Conditions, start: PointHistory, strain: FloatArray) -> Response:
    G, flow, shares = conditions.shear_modulus, conditions.flow, conditions.shares
    carried, strained = shares.carried[:, None], shares.strained
    stretched = strain - start.strain - conditions.shape
    elastic = carried * start.elastic + strained[:, None] * stretched
    plastic, equivalent = carried * start.plastic, shares.carried * start.equivalent
    trial = (2 * G)[:, None] * elastic
    none = np.zeros(len(G))
    if flow is None:
        return Response(
            trial, 2 * G * strained, none, np.zeros_like(trial), elastic, plastic, equivalent, none
        )
    back = (2 / 3 * flow.kinematic_modulus)[:, None] * plastic
    returned = return_mapping(trial, back, equivalent, flow)
    flowed = viscoplastic_strain(returned)
    return Response(
        returned.stress, returned.isotropic * strained, returned.radial * strained,
        returned.direction, elastic - flowed, plastic + flowed, equivalent + returned.increment,
        plastic_work(returned),
    )  # fmt: skip


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
