"""Which bodies have a coherency, with its source."""

import pytest

from castx.case.coherency import coherencies, coherency_records, sensitivity_command
from castx.case.reading.read import load_case
from castx.materials.database import database_entry, database_names
from tests.castx.command_line import ALLOY_CASE, content_of

pytestmark = pytest.mark.serial


def found(*overrides):
    return coherencies(load_case(content_of(ALLOY_CASE), overrides))


def test_the_casting_has_that_of_the_database_with_its_source():
    (casting,) = found()
    assert (casting.body, casting.material, casting.value) == ("casting", "AlSi7Mg", 0.9)
    assert casting.source.startswith("within the solid fractions of 0.80 to 0.95")
    assert "AlSi7Mg bears from a solid fraction (coherency) of 0.9 on; within" in casting.text
    records = coherency_records(load_case(content_of(ALLOY_CASE)))
    assert records == {"casting": {"value": 0.9, "source": casting.source}}


def test_a_number_of_the_case_is_its_own_source():
    given = 'materials.mine={extends="AlSi7Mg", liquid={viscosity=1e6, coherency=0.7}}'
    (casting,) = found(given, "bodies.0.material=mine")
    assert (casting.value, casting.source) == (0.7, "case file")


@pytest.mark.parametrize(
    "override",
    [
        "bodies.0.material=Al-pure",  # freezes at one temperature
        "bodies.0.temperature=500",  # starts solid
        "coupling.scheme=thermal",
        'materials.AlSi7Mg={extends="AlSi7Mg", liquid="none"}',
    ],
)
def test_where_it_has_no_meaning_there_is_none(override):
    assert found(override) == []


def test_a_rigid_body_has_none():
    assert found("bodies.0.law=rigid", 'interfaces.0.bodies=["mould", "casting"]') == []


@pytest.mark.parametrize("name", database_names())
def test_each_coherency_of_the_database_has_a_source_or_is_called_representative(name):
    entry = database_entry(name)
    if entry.description.liquid is not None:
        source = entry.sources["liquid.coherency"].text
        freezing = entry.description.freezing_range
        isothermal = freezing is not None and freezing[0] == freezing[1]
        known = ("without meaning",) if isothermal else ("representative value", "(19", "(20")
        assert any(word in source for word in known)


def test_the_command_names_the_case_file():
    assert sensitivity_command("a.toml") == "castx run a.toml --sensitivity coherency"
