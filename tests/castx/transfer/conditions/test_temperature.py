"""Heat condition `temperature`: a table over time, in °C."""

from __future__ import annotations

import pytest

from castx.transfer.conditions.temperature import CONDITION
from tests.heat_conditions import surface_heat

pytestmark = pytest.mark.serial


def test_the_surface_follows_the_table():
    heat = surface_heat("mould/outside", "temperature", value=[[0, "293.15 K"], [10, 80]])
    assert heat.gives_temperature and not heat.gives_flux
    table = CONDITION.temperature(heat.condition.given)
    assert (table(0.0), table(5.0), table(99.0)) == pytest.approx((20.0, 50.0, 80.0))


def test_a_surface_that_is_hotter_at_its_end_names_its_temperatures():
    """A table does; a formula names none."""
    along = {"along": "x", "table": [[0, 20], ["2 m", "353.15 K"]]}
    (named,) = surface_heat("a/b", "temperature", value=along).condition.temperatures
    assert (named.values.min(), named.values.max()) == pytest.approx((20.0, 80.0))
    heat = surface_heat("a/b", "temperature", value={"formula": "20 + 30*x"})
    assert heat.condition.temperatures == []
