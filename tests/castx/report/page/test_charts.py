"""The figures that a run has data for, with the lines they should have."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from castx.report.page.charts import (
    NUMERICS,
    Panel,
    Section,
    body_temperatures,
    columns,
    contact,
    cooling,
    displacements,
    interface_gaps,
    merged,
    moments_to_look_at,
    numbers,
    numerics,
    run_sections,
    solidification,
)
from castx.results.files.run_tables import Columns

pytestmark = pytest.mark.serial

TIME = np.array([0.0, 1.0, 2.0])


def results(**changes):
    """Return what the figures read of a results folder."""
    record = {
        "bodies": {
            "casting": {"freezes": [577.0, 613.0]},
            "mould": {"freezes": None},
        },
        "interfaces": {"casting/mould": {}},
    }
    history = {
        "time": TIME,
        "step": np.array([0.0, 1.0, 1.0]),
        "heat_iterations": TIME,
        "mechanics_iterations": TIME,
        "passes": TIME,
        "energy_error": np.array([0.0, -1e-9, 1e-8]),
        "casting.solid_fraction": 0.5 * TIME,
        "casting/mould.heat": 1e3 * TIME,
        "casting/outside.heat": -TIME,
    }
    probes = {
        "time": TIME,
        "centre.temperature": 700.0 - TIME,
        "wall.gap": 1e-6 * TIME,
        "wall.displacement.r": 1e-6 * TIME,
        "wall.displacement.z": 2e-6 * TIME,
    }
    parts = {
        "record": record, "history": Columns(history), "probes": Columns(probes),
        "model": "axisymmetric", "freezing": ["casting"], "measured": {},
    }  # fmt: skip
    return SimpleNamespace(**parts | changes)


def test_columns_are_chosen_by_their_end():
    series = {"a.gap": TIME, "b.gap": 2 * TIME, "gap": TIME, "a.gaps": TIME}
    found = columns(series, "gap", 1e6)
    assert list(found) == ["a", "b"]
    np.testing.assert_array_equal(found["b"], 2e6 * TIME)


def test_cooling_curves_show_where_the_casting_freezes():
    (panel,) = cooling(results())
    assert list(panel.lines) == ["centre"]
    assert panel.levels == {"solidus": 577.0, "liquidus": 613.0}
    run = results()
    run.record["bodies"]["casting"]["freezes"] = [660.0, 660.0]
    assert cooling(run)[0].levels == {"melting point": 660.0}


def test_temperatures_of_bodies_need_no_probe():
    run = results()
    run.history |= {
        "casting.max_temperature": 700.0 - TIME,
        "casting.mean_temperature": 690.0 - TIME,
        "casting.min_temperature": 680.0 - TIME,
        "mould.max_temperature": np.array([20.0, 25.0, np.nan]),
        "mould.mean_temperature": np.array([20.0, 20.0 + 4e-15, np.nan]),
        "mould.min_temperature": 20.0 + 0.0 * TIME,
    }
    hottest, mean, coldest = body_temperatures(run)
    assert [panel.label for panel in (hottest, mean, coldest)] == [
        "hottest [°C]", "mean [°C]", "coldest [°C]",
    ]  # fmt: skip
    assert list(hottest.lines) == ["casting", "mould"]
    assert list(mean.lines) == list(coldest.lines) == ["casting"], "a line that stays says nothing"
    np.testing.assert_array_equal(coldest.lines["casting"], 680.0 - TIME)
    assert mean.levels == {"solidus": 577.0, "liquidus": 613.0}
    assert body_temperatures(results()) == [], "results of older versions have none"


def test_heat_is_that_of_interfaces_and_counts_per_metre_in_plane_models():
    fraction, heat = solidification(results())
    np.testing.assert_array_equal(fraction.lines["casting"], 50.0 * TIME)
    assert list(heat.lines) == ["casting/mould"] and heat.label == "heat passed [kJ]"
    np.testing.assert_array_equal(heat.lines["casting/mould"], TIME)
    assert solidification(results(model="plane-strain"))[1].label == "heat passed [kJ/m]"


def test_there_are_panels_only_for_what_was_probed():
    assert [panel.label for panel in contact(results())] == ["gap [µm]"]
    found = displacements(results())
    assert [panel.label for panel in found] == ["displacement r [µm]", "displacement z [µm]"]
    np.testing.assert_allclose(found[1].lines["wall"], 2.0 * TIME)


def test_the_energy_error_is_shown_where_there_is_one():
    assert numerics(results())[-1].logarithmic
    quiet = results()
    quiet.history["energy_error"] = 0.0 * TIME
    assert [panel.label for panel in numerics(quiet)][-1] == "iterations, passes"


def test_sections_without_lines_are_left_out():
    found = run_sections(results(probes=Columns({"time": TIME})))
    assert [section.title for section in found] == ["Solidification and heat", NUMERICS]
    run = results(probes=Columns({"time": TIME}))
    run.history["casting.mean_temperature"] = 700.0 - TIME
    assert run_sections(run)[0].title == "Temperatures of the bodies"


def test_curves_can_be_looked_at_until_all_is_solid_and_until_stages_begin():
    process = [{"stage": 1, "cycle": 1, "time": 1.5}, {"stage": 1, "cycle": 2, "time": 1.9}]
    record = results().record | {"process": process}
    run = results(record=record)
    assert moments_to_look_at(run) == {"all solid": 2.0, "stage 1": 1.5}
    assert run_sections(run)[0].until == {"all solid": 2.0, "stage 1": 1.5}
    slower = [Section("Curves", "", TIME, [Panel("p", {"a": TIME})], {"all solid": 9.0})]
    (found,) = merged({"first": [replace(slower[0], until={"all solid": 3.0})], "last": slower})
    assert found["until"] == {"all solid": 9.0}


def test_curves_keep_seven_digits_and_know_what_is_no_number():
    assert numbers(np.array([1.23456789e-5, np.nan, np.inf])) == [1.234568e-5, None, None]


def page(run, **changes):
    parts = {"label": "T", "lines": {"a": 2.0 * TIME}, "levels": {"solidus": 3.0}}
    return {run: [Section("Cooling", "hot", TIME, [Panel(**parts | changes)])]}


def test_one_run_has_its_curves_and_points_under_their_names():
    (found,) = merged(page("first", points={"a": (TIME[:2], TIME[:2])}))
    (panel,) = found["panels"]
    computed, measured = panel["tables"]
    assert computed["time"] == list(TIME) and computed["lines"][0]["values"] == [0.0, 2.0, 4.0]
    assert computed["lines"][0]["name"] == "a" and panel["levels"] == {"solidus": 3.0}
    assert measured["measured"] and measured["lines"][0]["name"] == "a, measured"
    assert panel["abscissa"] == "time [s]"
    (other,) = merged(page("first", abscissa="gap [um]"))[0]["panels"]
    assert other["abscissa"] == "gap [um]"


def test_several_runs_share_the_diagrams_of_one_name():
    (found,) = merged(page("first") | page("second"))
    (panel,) = found["panels"]
    assert [table["lines"][0]["name"] for table in panel["tables"]] == ["a, first", "a, second"]
    assert {table["lines"][0]["curve"] for table in panel["tables"]} == {"a"}
    (apart,) = merged(page("first") | page("second", label="p"))
    assert [panel["label"] for panel in apart["panels"]] == ["T", "p"]


def test_gaps_of_interfaces_are_drawn_where_they_change():
    gap = np.array([np.nan, 1e-6, 3e-6])
    history = {
        "time": TIME, "casting/mould.mean_gap": gap, "casting/mould.max_gap": 2 * gap,
        "core/mould.mean_gap": 0 * TIME, "core/mould.max_gap": np.full(3, np.nan),
    }  # fmt: skip
    mean, largest = interface_gaps(results(history=Columns(history)))
    assert mean.label == "mean gap [µm]" and list(mean.lines) == ["casting/mould"]
    assert largest.lines["casting/mould"][2] == pytest.approx(6.0) and largest.least == 1.0
    assert interface_gaps(results()) == []
