"""Fields of stress: invariants against eigenvalues and hand-made states."""

import numpy as np
import pytest

from castx.case.fields.stress import FIELDS, von_mises
from tests.castx.case.fields.samples import KnownState, by_name, displayed

pytestmark = pytest.mark.serial
STATE, BY_NAME = KnownState(), by_name(FIELDS)


def principal(stress):
    """Return the principal values of one stress xx yy zz xy xz yz, rising."""
    xx, yy, zz, xy, xz, yz = stress
    return np.linalg.eigvals(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])).real.tolist()


def test_values_are_those_of_the_state():
    assert BY_NAME["stress"].values(STATE) is STATE.tensors
    assert BY_NAME["point_stress"].values(STATE) is STATE.point_tensors
    assert BY_NAME["plastic_strain"].values(STATE) is STATE.plastic
    assert BY_NAME["pressure"].values(STATE) is STATE.mean_stress


def test_invariants_follow_from_the_principal_values():
    values = np.array([sorted(principal(stress)) for stress in STATE.tensors])
    low, middle, high = values.T
    assert BY_NAME["largest_principal_stress"].values(STATE) == pytest.approx(high)
    assert BY_NAME["smallest_principal_stress"].values(STATE) == pytest.approx(low)
    differences = (high - middle) ** 2 + (middle - low) ** 2 + (high - low) ** 2
    assert BY_NAME["von_mises"].values(STATE) == pytest.approx(np.sqrt(differences / 2))


def test_von_mises_of_tension_shear_and_pressure():
    tension, shear, pressure = [3.0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 2.0, 0], [5.0, 5.0, 5.0, 0, 0, 0]
    found = von_mises(np.array([tension, shear, pressure]))
    assert found == pytest.approx([3.0, 2.0 * np.sqrt(3.0), 0.0])


def test_tensors_have_six_components():
    assert {field.name for field in FIELDS if field.components == 6} == {"stress", "point_stress"}


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("von_mises", 5e6, "5 MPa"),
        ("plastic_strain", 0.01, "1 %"),
        ("largest_principal_stress", 2e7, "20 MPa"),
        ("smallest_principal_stress", -2e7, "-20 MPa"),
        ("pressure", 1e5, "0.1 MPa"),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(BY_NAME[name], value) == text
