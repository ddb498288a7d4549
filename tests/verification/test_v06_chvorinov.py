"""V6: the solidification time of plates in a sand mould grows with (V/A)².

Source: N. Chvorinov, Giesserei 27 (1940) 177. With perfect contact and sand that is thick enough,
plates of the same superheat have similar temperature fields, so the rule is exact.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.body import HeatBody
from tests.verification.heat_strips import (
    casting_on_mould,
    material,
    profile,
    run,
    solid_thickness,
    strip,
)

LATENT, TM, START, SAND = 9.5e8, 660.0, 700.0, 20.0
SIZE = 0.5e-3


def solidification_time(comm, thickness: float) -> float:
    """Return when the middle of a plate is solid; half of the plate is meshed."""
    half = thickness / 2
    # Rough time of solidification after Chvorinov: it sets the steps and the depth of the sand.
    expected = np.pi / 4 * (LATENT / (TM - SAND)) ** 2 / (0.6 * 1.76e6) * half**2
    depth = SIZE * np.ceil(8 * np.sqrt(0.6 / 1.76e6 * expected) / SIZE)
    mesh = strip(comm, size=SIZE, length=half, mould_length=float(depth))
    metal = material(
        heat_capacity={"solid": 2.9e6, "liquid": 2.6e6},
        conductivity={"solid": 210.0, "liquid": 95.0},
        latent_heat=LATENT,
        solidus=TM,
        liquidus=TM,
    )
    sand = material(heat_capacity=1.76e6, conductivity=0.6)
    heat = casting_on_mould(
        mesh, [HeatBody("casting", metal, START), HeatBody("mould", sand, SAND)], "perfect"
    )
    solid = [(0.0, 0.0)]
    run(
        heat,
        expected / 100,
        2 * expected,
        [None],
        look=lambda time: solid.append((time, solid_thickness(mesh, heat, SIZE) / half)),
    )
    assert profile(mesh, heat, "mould")[1][0] == pytest.approx(SAND, abs=0.5)
    times, parts = np.array(solid).T
    return float(times[np.flatnonzero(parts > 1 - 1e-9)[0]])


@pytest.mark.serial
def test_time_grows_with_the_square_of_the_modulus(comm):
    thickness = np.array([10e-3, 20e-3, 40e-3])
    times = np.array([solidification_time(comm, value) for value in thickness])
    constant = times / (thickness / 2) ** 2
    assert constant == pytest.approx(constant.mean(), rel=0.05)
