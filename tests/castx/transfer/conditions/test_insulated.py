"""Heat condition `insulated`: takes no numbers and gives nothing."""

from __future__ import annotations

import pytest

from castx.transfer.conditions.insulated import CONDITION
from tests.heat_conditions import surface_heat

pytestmark = pytest.mark.serial


def test_it_gives_neither_flux_nor_temperature():
    heat = surface_heat("mould/outside", "insulated")
    assert not heat.gives_flux and not heat.gives_temperature
    assert CONDITION.insulates and CONDITION.keys == ()
    assert heat.condition.temperatures == []
