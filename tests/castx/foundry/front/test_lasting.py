"""How long control volumes freeze from one solid fraction to another, where that is known."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.lasting import Lasting
from tests.castx.fakes import slab_mesh
from tests.castx.foundry.front.test_passing import EUTECTIC, LATENT, LEFT, LIQUIDUS, Curve

RANGES = (0.1, 0.4, 0.55)
GRADIENT, SPEED = 8e3, 1e-3


def lasting_of(body, fractions=RANGES):
    return Lasting(ControlVolumes(body), Curve(), fractions)


def width(low, high):
    """Return between which temperatures the solid fraction goes from one to the other [K]."""
    return (high - low) / (1.0 - LEFT) * (LIQUIDUS - EUTECTIC)


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_a_field_that_travels_spends_its_width_over_the_cooling_rate(comm, model):
    """Nodes have the temperatures of their places, the narrower range is a sixth of an element.

    Tolerance: within a step, in which a node cools by 0.4 K, enthalpies are linear and not
    temperatures.
    """
    size = 2e-3
    sizes = {"length": 4 * size, "width": 2 * size, "size": size}
    sizes |= {"depth": 2 * size} if model == "3d" else {}
    described = Geometry.model_validate({"generator": "slab", "model": model, **sizes})
    body = build_mesh(described, ["casting"], comm).bodies["casting"]
    lasting = lasting_of(body, (0.1, 0.4, 0.43))
    x, step = body.points[:, 0], 0.05
    instants = np.arange(0.0, 20.0, step)
    states = [Curve().enthalpy(640.0 + GRADIENT * (x - SPEED * time)) for time in instants]
    for before, after in pairwise(states):
        lasting.follow(before, after, step)
    exact = np.array([width(0.1, 0.4), width(0.4, 0.43)]) / (GRADIENT * SPEED)
    found = lasting.ended(states[-1])
    np.testing.assert_allclose(found, np.broadcast_to(exact[:, None], found.shape), rtol=5e-3)


@pytest.mark.parametrize("steps", [20, 200])
def test_what_freezes_everywhere_at_once_takes_its_share_of_the_heat(comm, steps):
    """Heat leaves evenly, down into the plateau, within which the last range lies."""
    body = slab_mesh(comm, 2e-3, 6e-3).bodies["casting"]
    fractions = (0.4, 0.7, 0.9)
    lasting = lasting_of(body, fractions)
    hot, cold = (float(Curve().enthalpy(np.array(T))) for T in (650.0, 540.0))
    levels = np.linspace(hot, cold, steps + 1)
    for before, after in pairwise(levels):
        assert np.isnan(lasting.ended(np.full(len(body.points), hot))).all()
        lasting.follow(*(np.full(len(body.points), value) for value in (before, after)), 70 / steps)
    mushy, plateau = LIQUIDUS - width(0.0, 0.4), LATENT * LEFT
    in_plateau = float(Curve().enthalpy(np.array(EUTECTIC)))
    ends = [float(Curve().enthalpy(np.array(mushy))),
            *(in_plateau - plateau * (f - 1.0 + LEFT) / LEFT for f in fractions[1:])]  # fmt: skip
    exact = -np.diff(ends) * 70 / (hot - cold)
    found = lasting.ended(np.full(len(body.points), cold))
    # Where the plateau begins, the temperature is linear in a quarter of a step.
    np.testing.assert_allclose(found, np.broadcast_to(exact[:, None], found.shape), rtol=1 / steps)


@pytest.mark.serial
def test_temperatures_are_linear_in_quarters_of_a_step(comm):
    """Liquidus and eutectic are passed after one and three of them, so that each is exact."""
    body = slab_mesh(comm, 2e-3, 6e-3).bodies["casting"]
    lasting = lasting_of(body, (0.05, 0.4))
    below = np.array([0.0, width(0.0, 0.05), width(0.0, 0.4), LIQUIDUS - EUTECTIC])
    liquidus, first, last, eutectic = Curve().enthalpy(LIQUIDUS - below)
    whole = 2.0 * (liquidus - eutectic)
    before, after = liquidus + 0.25 * whole, liquidus - 0.75 * whole
    lasting.follow(*(np.full(len(body.points), value) for value in (before, after)), 60.0)
    np.testing.assert_allclose(lasting.durations, 60.0 * (first - last) / whole, rtol=1e-5)


@pytest.mark.serial
def test_a_tenth_of_a_kelvin_below_all_ranges_they_have_ended(comm):
    body = slab_mesh(comm, 2e-3, 6e-3).bodies["casting"]
    lasting, nodes = lasting_of(body, (0.1, 0.4)), np.ones(len(body.points))
    end = LIQUIDUS - width(0.0, 0.4)
    hot, above, below = (Curve().enthalpy(T * nodes) for T in (650.0, end + 0.1, end - 0.1))
    lasting.follow(hot, above, 1.0)
    assert np.isnan(lasting.ended(above)).all()
    lasting.follow(above, below, 1.0)
    assert np.isfinite(lasting.ended(below)).all()


def test_what_melts_again_begins_anew(comm):
    body = slab_mesh(comm, 2e-3, 6e-3).bodies["casting"]
    lasting = lasting_of(body)
    liquid, mushy, solid = (
        np.full(len(body.points), float(Curve().enthalpy(np.array(T)))) for T in (650, 590, 540)
    )
    lasting.follow(liquid, mushy, 1.0)
    once = lasting.durations.copy()
    assert (once[0] > 0.0).all() and np.isnan(lasting.ended(mushy)).all()
    lasting.follow(mushy, liquid, 1.0)
    lasting.follow(liquid, mushy, 1.0)
    np.testing.assert_allclose(lasting.durations, once, rtol=1e-12)
    lasting.follow(mushy, solid, 1.0)
    assert (lasting.ended(solid)[0] > once[0]).all()


def test_metal_whose_way_is_not_known_has_no_duration_until_it_melts(comm):
    body = slab_mesh(comm, 2e-3, 8e-3).bodies["casting"]
    lasting = lasting_of(body)
    x = body.points[:, 0]
    amid = Curve().enthalpy(np.where(x < 3e-3, 590.0, 650.0))
    lasting.begin_amid(amid)
    solid, liquid = (np.full(len(x), float(Curve().enthalpy(np.array(T)))) for T in (540, 650))
    lasting.follow(amid, solid, 1.0)
    found = lasting.ended(solid)
    assert np.isnan(found[:, x < 3e-3]).all() and np.isfinite(found[:, x > 3e-3]).all()
    lasting.follow(solid, liquid, 1.0)
    lasting.follow(liquid, solid, 1.0)
    assert np.isfinite(lasting.ended(solid)).all()
