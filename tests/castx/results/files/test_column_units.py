"""Units of columns of history.csv: of the turn or the part in space, and of plane models."""

import pytest

from castx.results.files.column_units import PER_DEPTH, UNITS, unit_of
from castx.results.history import BODY_TOTALS, COUNTERS, INTERFACE_TOTALS, RUN_TOTALS

pytestmark = pytest.mark.serial

COLUMNS = [
    ("time", "s", "s"),
    ("heat_iterations", "1", "1"),
    ("casting.solid_fraction", "1", "1"),
    ("casting.mean_temperature", "°C", "°C"),
    ("casting.enthalpy", "J", "J/m"),
    ("casting/mould.power", "W", "W/m"),
    ("casting/mould.heat.radiation", "J", "J/m"),
    ("casting/mould.force.z", "N", "N/m"),
    ("casting/mould.max_gap", "m", "m"),
    ("casting.feeder_level.top", "m", "m"),
    ("casting.pipe_volume", "m³", "m³/m"),
    ("casting.pocket_pressure", "Pa", "Pa"),
    ("casting.melt_suction", "Pa", "Pa"),
    ("mould/back.clamp_force", "N", "N/m"),
    ("mould/back.clamp_displacement", "m", "m"),
    ("casting.support_moment.x", "N m", "N m/m"),
    ("largest_pull", "N", "N/m"),
    ("energy_error", "1", "1"),
    ("temperature_error", "K", "K"),
    ("gap_error", "m", "m"),
    ("strain_error", "1", "1"),
]


@pytest.mark.parametrize(("column", "whole", "plane"), COLUMNS)
def test_units(column, whole, plane):
    assert unit_of(column, "axisymmetric") == unit_of(column, "3d") == whole
    assert unit_of(column, "plane-strain") == unit_of(column, "plane-stress") == plane


def test_what_is_followed_has_a_unit_or_is_a_number():
    known = {*BODY_TOTALS, *INTERFACE_TOTALS, *RUN_TOTALS, *COUNTERS}
    numbers = {"solid_fraction", "closed_fraction", "cycle", "stage"}
    numbers |= {"force_error", "energy_error", "strain_error"}
    counted = {*COUNTERS} - {"step", "wall"}
    assert known - UNITS.keys() == numbers | counted
    assert set(PER_DEPTH) < set(UNITS.values())
