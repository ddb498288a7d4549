import numpy as np
import pytest

from castx.proof.verification.solids.freezing_plate import (
    LENGTH,
    VERIFICATION,
    Plate,
    reference,
)
from castx.proof.verification.verification import Resolution

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("biot", [0.5, 4.0])
def test_much_latent_heat_makes_the_skin_quasi_steady(biot):
    """T is linear over the skin X, so that ∫T dx = −Bi X²/(2 y) with y = 1 + Bi X.

    X + Bi X²/2 = Bi Ste t, and dε = d(∫T dx)/X gives ε = −½ (ln y + Bi X/y).
    """
    stefan, skin = 1e-3, 0.75
    end = (skin + biot * skin**2 / 2) / (biot * stefan)
    found = reference(Plate(biot, end, 4, stefan))[1][-1]
    y = 1 + biot * skin
    assert found == pytest.approx(-0.5 * (np.log(y) + biot * skin / y), rel=1e-3)


def test_a_coarse_run(comm):
    outcome = VERIFICATION.run(Resolution(LENGTH / 8), comm)
    assert all(answer.error < 4 * answer.tolerance for answer in outcome.answers)
    assert 0.0 < outcome.norm < 0.05
