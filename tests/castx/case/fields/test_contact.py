"""Fields of interfaces: read from the pairs, shown in the units of a foundry."""

import numpy as np
import pytest

from castx.case.fields.contact import FIELDS, heat_transfer_coefficient
from tests.castx.case.fields.samples import KnownState, by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_values_are_those_of_the_pairs():
    state, fields = KnownState(), by_name(FIELDS)
    assert fields["gap"].values(state) is state.gaps
    assert fields["contact_pressure"].values(state) is state.pressures
    assert fields["wall_suction"].values(state) is state.pulls
    found = fields["heat_transfer_coefficient"].values(state)
    assert found == pytest.approx([1000.0, 500.0, 2000.0, np.inf])


@pytest.mark.filterwarnings("error")
def test_faces_without_resistance_give_no_warning():
    assert np.isinf(heat_transfer_coefficient(KnownState())).tolist() == [False] * 3 + [True]


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("gap", 2.5e-5, "25 µm"),
        ("contact_pressure", 3e6, "3 MPa"),
        ("wall_suction", 2.5e4, "25 kPa"),
        ("heat_transfer_coefficient", 1500.0, "1500 W/m²/K"),
        ("first_opening", 12.5, "12.5 s"),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text


def test_the_first_opening_is_followed_at_nodes():
    assert followed(FIELDS) == {"first_opening": "nodes"}
