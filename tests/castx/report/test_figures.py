"""The figures that a run has data for, with the lines they should have."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import pyvista

from castx.report.figures import (
    TOPICS,
    Figure,
    columns,
    contact,
    cooling,
    curve_figures,
    displacements,
    field_figures,
    numerics,
    solidification,
)
from castx.results.reading import Columns

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


def test_figures_without_lines_are_left_out():
    found = curve_figures(results(probes=Columns({"time": TIME})))
    titles = ["Solidification and heat", "How the solution went"]
    assert [figure.title for figure in found] == titles
    assert all(figure.png.startswith(b"\x89PNG") for figure in found)


def test_a_picture_is_part_of_the_page():
    assert Figure("a", "b", b"abc").source == "data:image/png;base64,YWJj"


def grids(time):
    """Return a casting in a mould with some of the fields of the report."""
    found = {}
    for left, name in enumerate(("casting", "mould")):
        image = pyvista.ImageData(dimensions=(4, 4, 1), origin=(3.0 * left, 0.0, 0.0))
        found[name] = image.cast_to_unstructured_grid()
        x = found[name].points[:, 0]
        found[name]["temperature"] = 600.0 - 50.0 * time * x
        found[name]["gap"] = 1e-6 * x
        found[name]["solidification_time"] = np.where(x > 0.5, x, np.nan)
        found[name]["displacement"] = np.zeros((found[name].n_points, 3))
        found[name]["von_mises"] = np.full(found[name].n_points, 1e-3)
    return found


def test_fields_are_shown_where_they_vary_and_were_written():
    found = field_figures(results(times=[0.0, 1.0], grids=grids))
    # Gaps are shown in space only; stresses of a millipascal are round-off.
    assert [figure.title for figure in found] == ["Temperature", "Local solidification time"]
    assert found[0].caption == "The blue line is f_s = 0.5."


def test_each_field_of_the_report_has_one_topic():
    fields = [topic.field for topic in TOPICS]
    assert len(set(fields)) == len(fields)
    assert all("[" in topic.label or topic.field == "solid_fraction" for topic in TOPICS)


def test_fields_of_the_foundry_have_pictures_that_say_where_they_were_taken():
    def with_pores(time):
        found = grids(time)
        x = found["casting"].points[:, 0]
        for name in ("pore_fraction", "passing_time_0.5", "passing_time_0.97"):
            found["casting"][name] = np.where(x > 0.5, x, np.nan)
        return found

    record = {**results().record, "front": "565.0 °C"}
    found = field_figures(results(record=record, times=[0.0, 1.0], grids=with_pores))
    captions = {figure.title: figure.caption for figure in found}
    assert "from the history at 565.0 °C" in captions["Shrinkage porosity"]
    assert {"Time of solid fraction 0.5", "Time of solid fraction 0.97"} < set(captions)
