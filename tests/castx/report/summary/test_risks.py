"""Hot spots and extremes of fields."""

import numpy as np
import pytest

from castx.report.summary.risks import FIELD_RISKS, alloy_risks, field_risks, hot_spots
from castx.results.states.quantities import MARGINS, UNITS
from tests.castx.report.summary.fake_run import grid, run

pytestmark = pytest.mark.serial

SPOT = {"body": "casting", "isolated": 1.5, "place": [0.01, 0.02], "volume": 4e-6, "deficit": 2e-7}


def test_the_worst_hot_spot_of_each_casting_counts():
    found = run(model="3d")
    found.record["hot_spots"] = [SPOT, {**SPOT, "deficit": 1e-7}, {**SPOT, "body": "other"}]
    first, second = hot_spots(found)
    assert first.number == "0.2 cm³" and first.time == 1.5 and second.of == "other"
    assert first.shown.time == 3.0  # it is there at the end


def test_a_hot_spot_that_lacks_nothing_is_none():
    """Iron swells by graphite as it freezes."""
    found = run(model="3d")
    found.record["hot_spots"] = [
        {**SPOT, "deficit": 0.0},
        {**SPOT, "body": "other", "deficit": 1e-9},
    ]
    assert [spot.of for spot in hot_spots(found)] == ["other"]


@pytest.mark.parametrize("ended, shown", [(0.5, 0.0), (1.0, 0.0), (2.5, 2.0), (None, 3.0)])
def test_a_hot_spot_is_shown_while_it_is_there_for_the_last_time(ended, shown):
    found = run(model="3d")
    found.record["hot_spots"] = [{**SPOT, "isolated": 0.0, "ended": ended}]
    (spot,) = hot_spots(found)
    assert spot.time == 0.0 and spot.shown.time == shown


def test_without_a_shrinkage_the_liquid_counts_and_in_the_plane_its_section():
    found = run()
    found.record["hot_spots"] = [{**SPOT, "deficit": None}]
    (spot,) = hot_spots(found)
    assert spot.number == "0.04 cm² of the section" and "cut off" in spot.sentence


def test_the_indices_of_the_alloy_of_each_casting():
    found = run()
    found.record["bodies"]["casting"]["tearing"] = {"kou": 900.0, "clyne_davies": None}
    (kou,) = alloy_risks(found)
    assert kou.number == "900 K" and kou.of == "casting"
    found.record["bodies"]["casting"]["tearing"]["clyne_davies"] = 0.25
    _, ratio = alloy_risks(found)
    assert ratio.value == 0.25 and "even cooling" in ratio.sentence
    assert not list(alloy_risks(run()))


def test_what_is_infinite_is_not_hidden_by_the_largest_number():
    name = f"{MARGINS}0.02"

    def grids(time):
        found = {"casting": grid(time)}
        values = np.linspace(0.1, 0.5, found["casting"].n_points)
        values[:3] = np.inf
        found["casting"][name] = values
        return found

    margins = [found for found in field_risks(run(grids=grids)) if name == found.shown.field]
    assert [found.number for found in margins] == ["30 % of the nodes", "0.5"]
    assert "without bounds" in margins[0].topic and "whatever the strain" in margins[0].sentence


def test_the_least_niyama_is_found_with_its_place_where_it_exists():
    (least,) = field_risks(run())
    grid_values = grid(3.0)["niyama"]
    assert least.value == np.nanmin(grid_values)
    assert least.place == pytest.approx([0.01, 0.0]) and "f_s = 0.9" in least.sentence


def test_values_in_cells_have_the_middle_of_their_cell_as_place():
    def grids(time):
        found = {"casting": grid(time)}
        found["casting"].cell_data["clyne_davies"] = np.array([0.1, 0.4, np.nan, 0.2])
        return found

    ratio = {finding.topic: finding for finding in field_risks(run(grids=grids))}["Hot tearing"]
    assert ratio.value == 0.4 and ratio.place == pytest.approx([0.015, 0.005])


def test_a_field_that_does_not_vary_is_no_risk():
    def grids(time):
        found = {"casting": grid(time)}
        found["casting"]["niyama"] = np.zeros(found["casting"].n_points)
        return found

    assert not list(field_risks(run(grids=grids)))


def test_risks_name_fields_that_exist():
    fields = {risk.field for risk in FIELD_RISKS}
    assert {name for name in fields if not name.startswith(MARGINS)} <= set(UNITS)
    assert len(fields) == len(FIELD_RISKS) == len({risk.topic for risk in FIELD_RISKS})
