import numpy as np
import pytest

from castx.proof.verification.coupled.cylinder import (
    CLOSED,
    GAS,
    LATENT,
    MELT,
    VERIFICATION,
    Cylinder1D,
    Slice1D,
    limited,
    reference,
    temperature_of,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_conduction_of_a_tube_is_logarithmic():
    tube = Cylinder1D(np.linspace(1.0, 2.0, 401))
    bands, T = tube.conduction(np.full(400, 3.0)), np.log(tube.r)
    flow = bands[1] * T
    flow[:-1] += bands[0, 1:] * T[1:]
    flow[1:] += bands[2, :-1] * T[:-1]
    assert (flow[0], flow[-1]) == pytest.approx((-3.0, 3.0), rel=1e-5)
    assert np.abs(flow[1:-1]).max() < 1e-5


@pytest.mark.parametrize("inner", [0.0, 0.4])
def test_even_heating_swells_a_free_cylinder(inner):
    """Between planes that do not move u = (1 + ν) ε r."""
    free = Cylinder1D(np.linspace(inner, 1.0, 51))
    u = free.displacement(np.full(50, 7e10), 0.3, np.full(50, 2e-3))
    np.testing.assert_allclose(u, 1.3 * 2e-3 * free.r, rtol=1e-9, atol=1e-15)


def test_enthalpy_melts_at_one_temperature():
    density = 2600.0
    T, slope, solid = temperature_of(density * LATENT * np.array([-0.1, 0.25, 1.0, 1.1]))
    assert T[0] < MELT and T[3] > MELT and (T[1], T[2]) == (MELT, MELT)
    np.testing.assert_allclose(solid, [1.0, 0.75, 0.0, 0.0])
    assert slope[1] == 0.0 and slope[0] > 0.0


def test_heat_goes_from_one_to_the_other():
    grid = Slice1D(60)
    old = grid.start()
    new = grid.advanced(old, 0.5, CLOSED)
    gained = grid.volume * (new - old)
    assert gained.sum() == pytest.approx(0.0, abs=1e-6 * np.abs(gained).sum())
    assert gained[grid.nodes :].sum() > 0.0


def test_the_gap_throttles():
    assert (limited(0.0, 0.0), limited(1e-6, 1.0)) == (CLOSED, CLOSED)
    assert limited(1e-3, 0.0) == pytest.approx(GAS / 1e-3)


def test_the_reference_does_not_hang_on_its_grid():
    times = np.array([2.0, 4.0])
    rough, fine = (reference(cells, step, times, 4.0) for cells, step in ((100, 0.04), (200, 0.02)))
    for name in ("centre", "surface", "mould"):
        np.testing.assert_allclose(rough[name], fine[name], atol=1.0)
    np.testing.assert_allclose(rough["gap"], fine["gap"], rtol=0.02)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
