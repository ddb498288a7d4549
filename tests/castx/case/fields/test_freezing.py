"""Fields of freezing: where they are, and in which units they are shown."""

import pytest

from castx.case.fields.freezing import FIELDS
from tests.castx.case.fields.samples import by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_freezing_is_followed_at_nodes_without_mechanics():
    assert set(followed(FIELDS).values()) == {"nodes"}
    assert len(followed(FIELDS)) == len(FIELDS)
    assert not any(field.mechanical for field in FIELDS)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("solidification_time", 60.0, "60 s"),
        ("gradient", 5000.0, "5 K/mm"),
        ("cooling_rate", 2.0, "2 K/s"),
        ("niyama", 1500.0, "1.5 K^½ s^½/mm"),
        ("front_speed", 0.001, "1 mm/s"),
        ("arm_spacing", 4e-5, "40 µm"),
        ("dimensionless_niyama", 20.0, "20"),
        ("pore_fraction", 0.005, "0.5 %"),
        ("yield_strength", 2.2e8, "220 MPa"),
        ("modulus", 0.015, "15 mm"),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text


def test_what_is_known_behind_the_front_is_shown_at_the_end_on_castings():
    for field in FIELDS:
        assert field.shown is None or (field.shown.final and field.shown.melting)
