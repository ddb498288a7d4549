"""Fields of feeding: where they are, and in which units they are shown."""

import numpy as np
import pytest

from castx.case.fields.feeding import FIELDS
from tests.castx.case.fields.samples import KnownState, by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_feeding_is_followed_at_nodes_without_mechanics():
    assert followed(FIELDS) == dict.fromkeys(("pool", "emptied", "feeding_path"), "nodes")
    assert [field.name for field in FIELDS if field.mechanical] == ["melt_suction", "pores"]


def test_suction_of_the_melt_is_tension_where_some_is_left():
    state = KnownState()
    state.mean_stress = np.array([-1e3, 2e3, 0.0, 4e3, 5e6])
    found = by_name(FIELDS)["melt_suction"].values(state)
    np.testing.assert_array_equal(found, [0.0, 2e3, 0.0, 4e3, 0.0])
    assert by_name(FIELDS)["pores"].values(state) is state.voids


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("emptied", 0.25, "25 %"),
        ("feeding_path", 0.12, "120 mm"),
        ("melt_suction", 2.5e4, "25 kPa"),
        ("pores", 0.02, "2 %"),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text


def test_numbers_of_pools_have_no_colours_of_their_own():
    assert by_name(FIELDS)["pool"].shown is None
