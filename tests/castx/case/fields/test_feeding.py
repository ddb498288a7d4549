"""Fields of feeding: where they are, and in which units they are shown."""

import pytest

from castx.case.fields.feeding import FIELDS
from tests.castx.case.fields.samples import by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_feeding_is_followed_at_nodes_without_mechanics():
    assert followed(FIELDS) == dict.fromkeys(("pool", "emptied", "feeding_path"), "nodes")
    assert not any(field.mechanical for field in FIELDS)


@pytest.mark.parametrize(
    "name, value, text", [("emptied", 0.25, "25 %"), ("feeding_path", 0.12, "120 mm")]
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text


def test_numbers_of_pools_have_no_colours_of_their_own():
    assert by_name(FIELDS)["pool"].shown is None
