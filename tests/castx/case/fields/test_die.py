"""Fields of dies: where they are, and in which units they are shown."""

import pytest

from castx.case.fields.die import FIELDS
from tests.castx.case.fields.samples import by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_life_and_its_strain_are_followed_in_cells_and_need_mechanics():
    assert followed(FIELDS) == {"strain_range": "cells", "life": "cells"}
    assert all(field.mechanical for field in FIELDS)


@pytest.mark.parametrize(
    "name, value, text", [("strain_range", 0.0035, "0.35 %"), ("life", 4.5, "4.5")]
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text


def test_dies_are_what_they_show():
    """They do not freeze: bodies that do not melt have the colours of those that do."""
    for field in FIELDS:
        assert field.shown is not None and not field.shown.melting
        assert field.shown.beside == field.shown.colours
