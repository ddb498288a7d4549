"""Integrals over the way of freezing, against closed forms and an adaptive quadrature."""

import numpy as np
import pytest
from scipy.integrate import quad

from castx.errors import CaseError
from castx.foundry.mush import FreezingPath, MushIntegral
from castx.foundry.porosity import resistance
from castx.materials.solid_fraction import LeverLaw, LinearLaw, ScheilLaw, TabulatedLaw

pytestmark = pytest.mark.serial

SCHEIL = FreezingPath(ScheilLaw(0.17, 660.3), 548.0, 645.0)
TABLE = FreezingPath(
    TabulatedLaw(((500.0, 1.0), (510.0, 0.9), (560.0, 0.7), (560.0, 0.4), (600.0, 0.0))),
    500.0,
    600.0,
)


def squares(first, last, width):
    """Return ∫ f²/(1-f)² dT where f runs straight over a width: (1/g + 2 ln g - g) of g = 1 - f."""

    def inner(g):
        return -1.0 / g - 2.0 * np.log(g) + g

    return width * (inner(1.0 - last) - inner(1.0 - first)) / (first - last)


def test_a_table_has_the_closed_form_of_each_row_and_nothing_on_its_plateau():
    found = MushIntegral(TABLE, resistance)(np.array([505.0, 530.0, 560.0, 580.0, 610.0]))
    hot, middle = squares(0.4, 0.0, 40.0), squares(0.9, 0.7, 50.0)
    exact = [
        squares(0.95, 0.9, 5.0) + middle + hot,
        squares(0.82, 0.7, 30.0) + hot,
        hot,
        squares(0.2, 0.0, 20.0),
        0.0,
    ]
    np.testing.assert_allclose(found, exact, rtol=1e-11)


def test_an_alloy_agrees_with_adaptive_quadrature():
    lever = FreezingPath(LeverLaw(0.3, 700.0), 520.0, 650.0)
    for path in (SCHEIL, lever):
        for start in (555.0, 590.0, 640.0):
            exact = quad(
                lambda t, path=path: resistance(path.solid_fraction(np.array([t])))[0],
                start,
                path.liquidus,
                epsabs=0.0,
                epsrel=1e-12,
            )[0]
            assert MushIntegral(path, resistance)(np.array([start]))[0] == pytest.approx(exact)


@pytest.mark.parametrize("path", [SCHEIL, TABLE, FreezingPath(LinearLaw(), 560.0, 615.0)])
def test_the_inverse_leads_back(path):
    integral = MushIntegral(path, resistance)
    temperature = path.solidus + path.freezing_range * np.array([1e-5, 1e-3, 0.1, 0.5, 0.9, 0.999])
    found = integral.inverse(integral(temperature))
    left = (found - path.solidus) / (temperature - path.solidus)
    np.testing.assert_allclose(left, 1.0, rtol=1e-7)


def test_temperatures_of_fractions():
    wanted = np.array([0.0, 0.2, 0.5, 0.8, 0.95, 1.0])
    np.testing.assert_allclose(
        TABLE.temperature(wanted), [600.0, 580.0, 560.0, 535.0, 505.0, 500.0], rtol=1e-12
    )
    scheil = 660.3 - (660.3 - 645.0) * 0.4 ** (0.17 - 1.0)
    assert SCHEIL.temperature(np.array([0.6]))[0] == pytest.approx(scheil, rel=1e-12)
    assert SCHEIL.temperature(np.array([0.99]))[0] == 548.0  # by the eutectic


def test_an_isothermal_change_has_no_mush():
    with pytest.raises(CaseError, match="without a freezing range has no mush"):
        FreezingPath(LinearLaw(), 660.0, 660.0)
