"""Pictures of several runs: of what they share, between the extremes of all of them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import pyvista

from castx.errors import CaseError
from castx.report.page.beside import common, first_of_each, has_fields, picture_rows
from castx.report.summary.finding import Finding, Shown
from castx.results.files.run_tables import Columns

pytestmark = pytest.mark.serial

SHOWN = Shown("temperature", ("casting",))


def finding(topic, shown=SHOWN):
    return Finding(topic, "casting", 1.0, "°C", "Warm.", place=(1.0, 1.0), shown=shown)


def results(hottest):
    """Return a casting from 0 °C to a temperature, without a mould."""
    grid = pyvista.ImageData(dimensions=(4, 4, 1)).cast_to_unstructured_grid()
    grid["temperature"] = hottest / 3.0 * grid.points[:, 0]
    return SimpleNamespace(
        grids=lambda time=2.0: {"casting": grid}, times=[2.0], model="plane-strain",
        freezing=["casting"], history=Columns({"time": np.array([2.0])}),
        record={"interfaces": {}}, nearest=lambda time, body=None: 2.0,
    )  # fmt: skip


class WithoutFields:
    """Results whose fields are gone."""

    @property
    def times(self):
        raise CaseError("there are no fields")


def named(*found):
    return {each.name: each for each in found}


def test_runs_share_the_ends_of_their_colours():
    both = named(finding("Hottest"), finding("Coldest", None))
    rows = picture_rows([(results(300.0), both), (results(600.0), both)])
    assert [row.name for row in rows] == ["Hottest: casting"]
    bars = [shot.bars[0] for shot in rows[0].shots]
    assert [(bar.low, bar.high) for bar in bars] == [("0", "600"), ("0", "600")]
    sources = {shot.source for shot in rows[0].shots}
    assert len(sources) == 2  # the same colours, other fields


def test_a_run_without_the_finding_has_a_gap_in_the_row():
    found = named(finding("Hottest"))
    rows = picture_rows([(results(300.0), found), (results(600.0), {}), (results(9.0), found)])
    assert [shot is None for shot in rows[0].shots] == [False, True, False]


def test_what_one_run_alone_has_is_not_drawn():
    runs = [(results(300.0), named(finding("Hottest"))), (results(600.0), {})]
    assert first_of_each(runs) == {} and picture_rows(runs) == []


def test_a_run_without_fields_has_no_pictures():
    found = named(finding("Hottest"))
    assert not has_fields(WithoutFields(), found)
    assert not has_fields(results(300.0), named(finding("Hottest", None)))
    assert has_fields(results(300.0), found)
    assert picture_rows([(results(300.0), found), (WithoutFields(), found)]) == []


def test_ends_of_colours_are_the_extremes():
    found = [{"a": (0.0, 2.0)}, {"a": (-1.0, 1.0), "b": (3.0, 4.0)}, {}]
    assert common(found) == {"a": (-1.0, 2.0), "b": (3.0, 4.0)}
