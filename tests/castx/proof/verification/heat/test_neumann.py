from dataclasses import replace

import numpy as np
import pytest

from castx.proof.verification.heat.neumann import VERIFICATION, Neumann
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial

METAL = Neumann()


def test_the_numbers_of_the_record():
    assert METAL.front_number == pytest.approx(0.2729601290, abs=1e-10)
    assert METAL.front(1.0) == pytest.approx(4.567496576e-3, rel=1e-9)
    assert METAL.wall_heat(1.0) == pytest.approx(2 * 3.76973e6, rel=1e-6)
    places = np.array([5e-3, 10e-3, 20e-3])
    assert METAL.temperature(places, 10.0) == pytest.approx([608.299, 636.098, 677.954], abs=1e-3)
    assert METAL.temperature(places, 1.0) == pytest.approx([664.632, 707.182, 737.339], abs=1e-3)


@pytest.mark.parametrize("metal", [METAL, replace(METAL, latent=2e8, start=900.0, wall=20.0)])
def test_heat_is_conducted_and_released_at_the_front(metal):
    """The heat equation and Stefan's condition by differences."""
    t, h, dt = 4.0, 1e-5, 1e-3
    X = metal.front(t)
    for x, part in ((0.5 * X, 0), (2.0 * X, 1)):
        points = np.array([x - h, x, x + h])
        T = metal.temperature(points, t)
        rate = (metal.temperature(points, t + dt) - metal.temperature(points, t - dt))[1] / 2 / dt
        curvature = (T[0] - 2 * T[1] + T[2]) / h**2
        assert rate == pytest.approx(metal.diffusivity[part] * curvature, rel=1e-3)
    h = 1e-6
    solid = (metal.melting - metal.temperature(np.array([X - h]), t)[0]) / h
    liquid = (metal.temperature(np.array([X + h]), t)[0] - metal.melting) / h
    speed = (metal.front(t + dt) - metal.front(t - dt)) / 2 / dt
    flux = metal.conductivity[0] * solid - metal.conductivity[1] * liquid
    assert flux == pytest.approx(metal.latent * speed, rel=1e-3)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
