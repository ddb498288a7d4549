"""Return to the cone of Drucker and Prager and its cut-off: exact states, tangent, bad strains."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.materials.granular import GranularData, GranularSurface, granular_surface
from castx.mechanics.constitutive.drucker_prager import (
    GranularReturn,
    relaxed,
    return_to_cone,
)

YOUNG, POISSON = 500e6, 0.25
G, K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
COHESION, FRICTION, DILATANCY, CUT = 0.8e6, 30.0, 8.0, 0.2e6
SINE = np.sin(np.radians(FRICTION))
CRUSHED = 2 * COHESION * np.cos(np.radians(FRICTION)) / (1 - SINE)
"""Strength in compression without side pressure, of Mohr and Coulomb."""

DIRECTIONS = np.array([[2.0, -1, -1, 0, 0, 0], [0, 0, 0, 1, 0, 0], [1.0, -0.4, -0.6, 0.3, -0.7, 2]])


def surface(**changes: Any) -> GranularSurface:
    given = {"cohesion": COHESION, "friction_angle": FRICTION, "dilatancy_angle": DILATANCY,
             "tension_cut_off": CUT} | changes  # fmt: skip
    return granular_surface(GranularData.read(given), np.array([20.0]))


def stressed(strain: FloatArray, yielding: GranularSurface) -> GranularReturn:
    """Return the state after strains from rest, shape (points, 6)."""
    volume = strain[:, :3].sum(axis=1)
    trial = 2 * G * strain
    trial[:, :3] -= 2 * G * volume[:, None] / 3
    one = np.ones(len(strain))
    return return_to_cone(trial, K * volume, G * one, K * one, yielding)


def total(found: GranularReturn) -> FloatArray:
    stress = found.stress.copy()
    stress[:, :3] += found.mean[:, None]
    return stress


def sideways(axial: float, pressure: float, yielding: GranularSurface) -> float:
    """Return the axial stress of a cylinder under a side pressure, strained along its axis."""
    strain = np.array([[axial, 0.0, 0, 0, 0, 0]])
    for _ in range(200):  # the side pressure by a secant of the elastic stiffness, which converges
        missing = total(stressed(strain, yielding))[0, 1] + pressure
        strain[0, 1:3] -= missing / (2 * (K + G / 3))
    assert abs(missing) < 1e-6 * COHESION
    return float(total(stressed(strain, yielding))[0, 0])


def test_a_cylinder_is_crushed_at_the_strength_of_mohr_and_coulomb() -> None:
    assert sideways(-0.02, 0.0, surface()) == pytest.approx(-CRUSHED, rel=1e-6)
    assert sideways(-1e-4, 0.0, surface()) == pytest.approx(-1e-4 * YOUNG, rel=1e-6)


def test_a_side_pressure_raises_the_strength_by_friction() -> None:
    side = 0.5e6
    strength = CRUSHED + side * (1 + SINE) / (1 - SINE)
    assert sideways(-0.03, side, surface()) == pytest.approx(-strength, rel=1e-6)


def test_a_cylinder_is_torn_where_cone_or_cut_off_is_reached() -> None:
    k, mu = surface().strength[0], surface().friction
    weak, strong = surface(tension_cut_off=0.1e6), surface(tension_cut_off=None)
    assert sideways(0.02, 0.0, strong) == pytest.approx(k / (1 + mu / 3), rel=1e-6)
    assert sideways(0.02, 0.0, weak) == pytest.approx(3 * 0.1e6, rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, FRICTION])
def test_pure_shear_yields_at_k_over_root_three_and_grows_by_its_dilatancy(angle) -> None:
    yielding = surface(dilatancy_angle=angle)
    found = stressed(np.array([[0, 0, 0, 0.01, 0, 0.0]]), yielding)
    q = np.sqrt(3) * found.stress[0, 3]
    assert q == pytest.approx(yielding.strength[0] - yielding.friction * found.mean[0])
    assert found.dilatation == pytest.approx(yielding.dilatancy * found.increment)
    assert (found.mean[0] == 0) == (angle == 0)  # held volume, so that growth is a pressure


def test_hydrostatic_tension_ends_at_the_cut_off_and_at_the_tip_of_the_cone() -> None:
    pulled = np.array([[0.01, 0.01, 0.01, 0, 0, 0]])
    for yielding, limit in (
        (surface(), CUT), (surface(tension_cut_off=None), COHESION / np.tan(np.radians(FRICTION))),
    ):  # fmt: skip
        found = stressed(pulled, yielding)
        assert found.mean == pytest.approx(limit)
        assert found.dilatation == pytest.approx(0.03 - limit / K)
        assert not found.increment.any()
    pressed = stressed(-pulled, surface())
    assert pressed.mean == pytest.approx(-0.03 * K)
    assert not pressed.dilatation.any()


def test_all_states_lie_on_or_below_cone_and_cut_off_and_gain_no_energy() -> None:
    random = np.random.default_rng(3).normal(size=(4000, 6)) * 6e-3
    for yielding in (surface(), surface(tension_cut_off=None), surface(dilatancy_angle=0)):
        found = stressed(random, yielding)
        q = np.sqrt(1.5 * (found.stress**2 @ [1, 1, 1, 2, 2, 2]))
        scale = yielding.strength[0] + np.abs(found.mean)
        assert (q + yielding.friction * found.mean - yielding.strength < 1e-9 * scale).all()
        assert (found.mean - yielding.cut_off < 1e-9 * scale).all()
        assert (q * found.increment + found.mean * found.dilatation > -1e-9 * scale * 1e-2).all()
        assert (found.increment > 0).any() and (found.increment == 0).any()


def regions() -> dict[str, FloatArray]:
    """Return strains that end inside, on the cone, at the cut-off, and at both."""
    shear, volume = np.array([DIRECTIONS[2]]), np.array([[1.0, 1, 1, 0, 0, 0]])
    return {
        "inside": 1e-4 * shear - 1e-4 * volume,
        "cone": 3e-3 * shear - 2e-3 * volume,
        "cut-off": 1e-4 * shear + 4e-3 * volume,
        "both": 5e-3 * shear + 4e-3 * volume,
    }


@pytest.mark.parametrize("region", [*regions()])
@pytest.mark.parametrize("changes", [{}, {"dilatancy_angle": FRICTION}, {"dilatancy_angle": 0}])
def test_tangent_agrees_with_differences_of_second_order(region, changes) -> None:
    strain, yielding = regions()[region], surface(**changes)
    found = stressed(strain, yielding)
    flows = {"inside": (0, 0), "cone": (1, changes.get("dilatancy_angle", 1) > 0),
             "cut-off": (0, 1), "both": (1, 1)}[region]  # fmt: skip
    assert (bool(found.increment.any()), bool(found.dilatation.any())) == flows
    for direction in np.eye(6):
        errors = []
        for size in (2e-6, 1e-6):
            step = size * direction[None]
            ahead, behind = stressed(strain + step, yielding), stressed(strain - step, yielding)
            difference = (total(ahead) - total(behind)) / (2 * size)
            errors.append(np.abs(difference - tangent(found, direction)).max())
        assert errors[0] <= max(2.0 * G * 1e-8, 8e-7 * K)
        assert errors[1] <= max(0.3 * errors[0], 2e-9 * K)


def tangent(found: GranularReturn, strain: FloatArray) -> FloatArray:
    volume = strain[:3].sum()
    deviator = strain.copy()
    deviator[:3] -= volume / 3
    along = found.direction @ (strain * [1, 1, 1, 2, 2, 2])
    change = found.isotropic[:, None] * deviator
    by = found.radial * along + found.stress_by_volume * volume
    change += by[:, None] * found.direction
    change[:, :3] += (found.mean_by_shear * along + found.bulk * volume)[:, None]
    return change


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_a_relaxed_state_keeps_its_share_of_the_trial_stress(share) -> None:
    strain, one = 5e-3 * DIRECTIONS[2:] + 1e-3, np.ones(1)
    strain[:, 3:] -= 1e-3
    volume = strain[:, :3].sum(axis=1)
    trial = 2 * G * strain
    trial[:, :3] -= 2 * G * volume[:, None] / 3
    at = return_to_cone(trial, K * volume, G * one, K * one, surface())
    found = relaxed(at, trial, K * volume, G * one, K * one, share)
    assert np.allclose(found.stress, at.stress + share * (trial - at.stress))
    assert np.allclose(found.mean, at.mean + share * (K * volume - at.mean))
    # What has not flowed is elastic.
    assert np.allclose(found.mean, K * (volume - found.dilatation))
    flow = np.sqrt(1.5) * found.increment[:, None] * found.direction
    assert np.allclose(found.stress, trial - 2 * G * flow)


def test_a_strain_that_is_not_finite_is_refused() -> None:
    with pytest.raises(ConvergenceError, match="not finite at 1 of 2 points, first at point 1"):
        stressed(np.array([[0.0] * 6, [np.nan] * 6]), surface())
