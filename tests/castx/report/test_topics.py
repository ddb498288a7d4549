"""How fields are shown."""

import pytest

from castx.report.topics import TOPICS, topics_of
from castx.results.states.quantities import UNITS

pytestmark = pytest.mark.serial


def test_each_field_has_one_topic_and_exists():
    fields = [topic.field for topic in TOPICS]
    assert len(set(fields)) == len(fields) and set(fields) <= set(UNITS)


def test_written_fields_are_shown_in_order_and_new_ones_behind():
    names = ["new_index", "tearing_margin_0.02", "gap", "temperature", "stress", "passing_time_0.5"]
    found = list(topics_of(names))
    assert [topic.field for topic in found] == [
        "temperature", "gap", "new_index", "passing_time_0.5", "tearing_margin_0.02"
    ]  # fmt: skip
    assert found[2].title == "New index" and found[2].label == "New index"
    assert found[3].title == "Time of solid fraction 0.5" and found[3].final
    assert "g_c = 0.02" in found[4].title and found[4].final
    assert found[1].label == "Gap [µm]"


def test_fields_without_a_topic_have_the_unit_of_their_numbers_and_shares_have_none():
    enthalpy, pool = topics_of(["pool", "enthalpy"])
    assert enthalpy.label == "Enthalpy [J/m³]" and pool.label == "Pool"
    assert not any(topic.unit == "1" for topic in topics_of(UNITS))


def test_numbers_are_shown_in_the_units_of_a_foundry():
    units = {topic.field: (topic.unit, topic.factor) for topic in topics_of(UNITS)}
    assert units["smallest_principal_stress"] == units["pressure"] == ("MPa", 1e-6)
    assert units["gradient"] == ("K/mm", 1e-3) and units["feeding_path"] == ("mm", 1e3)
    assert units["strain_range"] == ("%", 100.0) and units["heat_flux"] == ("kW/m²", 1e-3)
