"""Units of columns of history.csv: of the turn or the part in space, and of plane models."""

import pytest

from castx.results.files.column_units import PER_DEPTH, UNITS, unit_of
from castx.results.history import BODY_TOTALS, COUNTERS, INTERFACE_TOTALS, RUN_TOTALS
from tests.coupled_cases import ALUMINIUM, STEEL, final_state

pytestmark = pytest.mark.serial

COLUMNS = [
    ("time", "s", "s"),
    ("heat_iterations", "1", "1"),
    ("casting.solid_fraction", "1", "1"),
    ("casting.mean_temperature", "°C", "°C"),
    ("casting.enthalpy", "J", "J/m"),
    ("casting/mould.power", "W", "W/m"),
    ("casting/mould.heat.radiation", "J", "J/m"),
    ("mould/casting.surface.heat", "J", "J/m"),
    ("mould/casting.surface.power.radiation", "W", "W/m"),
    ("casting.renewal", "J", "J/m"),
    ("casting.dissipation", "J", "J/m"),
    ("casting.power.source", "W", "W/m"),
    ("casting.source", "J", "J/m"),
    ("casting.level_drop.heat", "m", "m"),
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


def test_what_a_run_with_stages_sums_up_has_a_unit_or_is_a_number(comm):
    """A slab in a mould that is sprayed once it is out, with a heat source, and cast again."""
    air = {"type": "convection", "coefficient": 30.0, "ambient": 20.0}
    state = final_state(comm, {
        "geometry": {"generator": "two_slabs", "model": "plane-strain", "length": 0.01,
                     "mould_length": 0.01, "width": 0.01, "size": 0.005},
        "materials": {"aluminium": ALUMINIUM, "steel": STEEL},
        "bodies": [{"name": "casting", "material": "aluminium", "temperature": 700.0},
                   {"name": "mould", "material": "steel", "temperature": 200.0}],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "constant", "closed": 800.0}}],
        "boundaries": [{"on": "mould/far", "heat": air}],
        "stages": [{"at": 1.0, "remove": ["casting"],
                    "boundaries": [{"on": "mould/casting", "heat": air}]},
                   {"at": 2.0, "repeat": 2, "renew": ["casting"]}],
        "time": {"end": 2.0, "fixed_step": 0.5},
        "coupling": {"scheme": "thermal"},
    })  # fmt: skip
    sums = {name for name in state.totals if unit_of(name, "3d") == "1"}
    assert {name.partition(".")[2] or name for name in sums} <= {
        "solid_fraction", "closed_fraction", "energy_error", "cycle", "stage"
    }  # fmt: skip
    assert {"casting.renewal", "mould/casting.surface.heat"} <= state.totals.keys()


def test_what_is_followed_has_a_unit_or_is_a_number():
    known = {*BODY_TOTALS, *INTERFACE_TOTALS, *RUN_TOTALS, *COUNTERS}
    numbers = {"solid_fraction", "closed_fraction", "cycle", "stage"}
    numbers |= {"force_error", "energy_error", "strain_error"}
    counted = {*COUNTERS} - {"step", "wall"}
    assert known - UNITS.keys() == numbers | counted
    assert set(PER_DEPTH) < set(UNITS.values())
