"""Keys that several laws share: what is usual can be read, and every key serves some law."""

from __future__ import annotations

import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.input.variation import Variation
from castx.transfer import keys
from castx.transfer.declaration import HeatKey, chosen
from castx.transfer.registry import gap_heat_laws, law_keys

pytestmark = pytest.mark.serial

SHARED = [value for value in vars(keys).values() if isinstance(value, HeatKey)]


@pytest.mark.parametrize("key", SHARED, ids=lambda key: key.name)
def test_a_shared_key_serves_laws_and_is_a_field_of_the_case(key):
    assert law_keys(gap_heat_laws())[key.name].entry == key.entry
    assert key.name in InterfaceHeat.model_fields


@pytest.mark.parametrize("key", law_keys(gap_heat_laws()).values(), ids=lambda key: key.name)
@pytest.mark.parametrize("end", [min, max])
def test_both_ends_of_the_usual_ranges_are_allowed(key, end):
    """A case is read with them: only other keys are missing or not used."""
    value = chosen(key.usual, end)
    for law in gap_heat_laws().values():
        if key in law.needed:
            heat = InterfaceHeat.read({**law.example(), key.name: value})
            given = heat.given.get(key)
            assert (given.table(0.0) if isinstance(given, Variation) else given) == value
        elif key.name in ("pressure", "radiation", "transition") and key in law.useful:
            assert key.name in InterfaceHeat.read({**law.example(), key.name: value}).given.values
