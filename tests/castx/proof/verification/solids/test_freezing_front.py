import numpy as np
import pytest

from castx.proof.verification.solids.freezing_front import FreezingFront
from castx.proof.verification.solids.freezing_plate import PLATES, Plate, reference
from tests.verification.freezing_grid import control_volumes, freezing

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("name", PLATES)
def test_the_strain_does_not_hang_on_the_degree(name):
    plate = PLATES[name]
    times = np.linspace(0.0, plate.end, 21)
    coarse, fine = (FreezingFront(plate.biot, plate.stefan, n).strains(times) for n in (8, 12))
    np.testing.assert_allclose(coarse, fine, rtol=1e-5, atol=1e-9)


def test_a_fine_grid_comes_closer_to_the_front():
    """By the first order of its steps: 0.4, 0.2 and 0.1 % at the end."""
    exact, off = reference(PLATES["die"])[1][-1], []
    for cells, steps in ((120, 1600), (240, 6400)):
        temperature, solid = freezing(Plate(1.0, 0.7, steps), cells)
        volumes = control_volumes(cells)
        amount = solid @ volumes
        cooled = np.diff(temperature @ volumes) / (0.5 * (amount[1:] + amount[:-1]))
        off.append(abs(cooled.sum() / exact - 1.0))
    assert off[0] < 8e-3
    assert off[1] < 0.6 * off[0]


def test_the_strain_is_zero_at_the_start_and_goes_on_behind_the_freezing():
    """All of it is solid at 1.0: it then cools to the surroundings, by αΔT in the end."""
    found = FreezingFront(4.0, 1.63).strains(np.array([0.0, 1e-9, 0.5, 1.2, 20.0, 30.0]))
    assert found[0] == found[1] == 0.0
    assert np.all(np.diff(found[1:5]) < 0.0)
    assert found[5] == pytest.approx(found[4], abs=1e-7)
