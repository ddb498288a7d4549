"""Fields of cracks: where they are, and in which units they are shown."""

import pytest

from castx.case.fields.cracking import FIELDS
from tests.castx.case.fields.samples import by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_hot_tears_are_followed_at_nodes_and_cold_cracks_in_cells():
    assert followed(FIELDS) == {
        "clyne_davies": "nodes", "brittle_strain": "nodes", "brittle_time": "nodes",
        "brittle_strain_index": "nodes", "tearing_margin": "nodes",
        "suction_margin": "nodes", "cold_crack_index": "cells",
    }  # fmt: skip


def test_the_ratio_of_times_alone_needs_no_mechanics():
    assert [field.name for field in FIELDS if not field.mechanical] == ["clyne_davies"]


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("clyne_davies", 0.4, "0.4"),
        ("brittle_strain", 0.002, "0.2 %"),
        ("brittle_strain_index", 1.2, "1.2"),
        ("brittle_time", 3.0, "3 s"),
        ("suction_margin", 0.46, "0.46"),
        ("cold_crack_index", 0.8, "0.8"),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text
