import numpy as np
import pytest

from castx.proof.verification.solids.solidifying_slab import OTHER, STEEL, VERIFICATION, solve
from castx.proof.verification.verification import Resolution

pytestmark = pytest.mark.serial


def test_the_reference_is_that_of_the_literature():
    exact = solve(STEEL)
    assert STEEL.front_number == pytest.approx(0.3308252956, rel=1e-9)
    assert exact.compression == pytest.approx(0.21570439, rel=1e-6)
    assert exact.tension == pytest.approx(0.45487188, rel=1e-6)
    assert exact.stress(exact.tension) == pytest.approx(21.280467e6, rel=1e-6)
    assert exact.rate * np.log(np.sqrt(10)) == pytest.approx(-0.00540436, rel=1e-5)


@pytest.mark.parametrize("slab", [STEEL, OTHER])
def test_the_stress_has_no_resultant_and_no_jump(slab):
    exact = solve(slab)
    xi = np.linspace(0.0, 1.0, 20001)
    stress = exact.stress(xi)
    assert abs(np.trapezoid(stress, xi)) < 1e-4 * slab.yield_at_wall
    assert np.abs(np.diff(stress)).max() < 1e-3 * slab.yield_at_wall


def test_a_coarse_run(comm):
    """Too coarse for the tolerance of the stress: strain, and the force that must vanish."""
    outcome = VERIFICATION.run(Resolution(STEEL.front(10.0) / 30, 0.25), comm)
    _, strain, force = outcome.answers
    assert strain.error < 2 * strain.tolerance and force.error < force.tolerance
    assert outcome.norm < 0.15
