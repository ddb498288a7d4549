"""A results folder at a word: findings, curves with their units and points, tables, notebooks."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import numpy as np
import pytest

import castx
from castx.errors import CaseError
from castx.report.summary.finding import Finding
from castx.report.summary.opened import FindingList, finding_row, html_table
from castx.report.summary.registry import findings

pytestmark = pytest.mark.serial

GAP = Finding("Largest gap", "a/b", 2e-4, "µm", "It is wide.", 1e6, (0.02, 0.01), 5.0)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Return a short run with a measured curve."""
    folder = tmp_path_factory.mktemp("opened")
    (folder / "logged.csv").write_text("time,centre.temperature\n0,671\n0.05,669\n0.1,668\n")
    measured = f'measurements=[{{of="centre.temperature",file="{folder / "logged.csv"}"}}]'
    changes = ["time.end=0.1", "geometry.size=1e-2", measured]
    return castx.Results(castx.run("demos/cylinder.toml", changes, output=folder / "out"))


def test_findings_are_those_of_the_report(results):
    found = results.findings()
    assert [each.name for each in found] == [each.name for each in findings(results)]
    assert any(each.topic == "Largest gap" for each in found)
    text = repr(found)
    assert text.count("\n") == len(found) - 1 and "Largest gap (casting/mould)" in text


def test_the_run_has_kept_where_its_castings_froze_last(results):
    """Of fields alone it would be as coarse as their moments."""
    assert "casting" in results.record["last_liquid"]


def test_a_list_of_findings_shows_place_time_and_error():
    rows = FindingList([GAP], "axisymmetric").rows()
    assert rows == [("Largest gap", "a/b", "200 µm", "r 20.0, z 10.0 mm, t = 5 s")]
    assert FindingList([], "3d").rows() == []
    page = FindingList([GAP], "axisymmetric")._repr_html_()
    assert "<td>200 µm</td>" in page and "z 10.0 mm" in page


def test_texts_of_tables_are_escaped():
    assert "<td>&lt;b&gt;</td>" in html_table(("a",), [("<b>",)])


def test_curves_have_their_numbers_units_and_points(results):
    figure = results.plot("centre.temperature")
    (axes,) = figure.axes
    computed, measured = axes.lines
    np.testing.assert_array_equal(computed.get_ydata(), results.probes["centre.temperature"])
    np.testing.assert_array_equal(measured.get_ydata(), [671.0, 669.0, 668.0])
    assert axes.get_ylabel() == "centre.temperature [°C]" and axes.get_xlabel() == "time [s]"


def test_each_unit_has_its_diagram(results):
    figure = results.plot("casting/mould.max_gap", "centre.temperature", "casting/mould.mean_gap")
    assert [len(axes.lines) for axes in figure.axes] == [2, 2]
    assert [axes.get_ylabel() for axes in figure.axes] == ["[m]", "centre.temperature [°C]"]
    np.testing.assert_array_equal(
        figure.axes[0].lines[1].get_ydata(), results.history["casting/mould.mean_gap"]
    )


def test_without_a_name_all_probes_are_drawn(results):
    figure = results.plot()
    drawn = {line.get_label() for axes in figure.axes for line in axes.lines}
    assert {name for name in results.probes if name != "time"} <= drawn


def test_a_column_that_is_not_there_is_refused(results):
    with pytest.raises(CaseError, match=r'did you mean "centre\.temperature"'):
        results.plot("center.temperature")


def test_tables_become_data_frames(results, monkeypatch):
    class DataFrame:
        def __init__(self, content):
            self.content = content

        def set_index(self, name):
            self.index = name
            return self

    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=DataFrame, __spec__=1))
    probes, history = results.data_frame(), results.data_frame("history")
    assert probes.index == history.index == "time"
    assert probes.content["centre.temperature"] is results.probes["centre.temperature"]
    assert "casting/mould.max_gap" in history.content
    rows = results.data_frame("findings").content
    assert [row["value"] for row in rows] == [found.value for found in results.findings()]
    with pytest.raises(CaseError, match=r'no table "?.prob'):
        results.data_frame("probe")


def test_without_pandas_the_cure_is_named(results, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(CaseError, match="pip install pandas"):
        results.data_frame()


def test_findings_are_rows_in_si():
    row = finding_row(GAP)
    assert row["value"] == 2e-4 and row["shown"] == "200 µm" and row["place"] == (0.02, 0.01)


def test_a_notebook_shows_the_run_and_its_findings(results):
    text = repr(results)
    assert "finished at t = 0.1 s" in text and "casting/mould" in text
    assert f"{len(results.times)} moments, 0 to 0.1 s" in text
    page = results._repr_html_()
    assert "finished at t = 0.1 s" in page and "Largest gap" in page


def test_a_run_without_fields_is_shown_too(results, tmp_path):
    for name in ("run.json", "history.csv", "probes.csv"):
        (tmp_path / name).write_bytes((results.folder / name).read_bytes())
    assert "fields      none" in repr(castx.Results(tmp_path))
