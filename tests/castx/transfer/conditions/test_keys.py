"""Keys that several heat conditions share."""

from __future__ import annotations

import pytest

from castx.transfer.conditions import keys
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.declaration import HeatKey

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "key", [value for value in vars(keys).values() if isinstance(value, HeatKey)]
)
def test_a_shared_key_serves_several_conditions(key):
    assert sum(key in kind.keys for kind in heat_conditions().values()) > 1


def test_the_temperature_of_the_surroundings_is_a_table_in_degrees_celsius():
    assert keys.AMBIENT.text == "ambient [°C]"
    assert keys.AMBIENT.read("293.15 K")(7.0) == pytest.approx(20.0)
    assert keys.AMBIENT.read([[0, 20], [10, "40 degC"]])(5.0) == pytest.approx(30.0)
