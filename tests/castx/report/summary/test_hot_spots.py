"""The table of hot spots: units by model, what is unknown, and its length."""

from __future__ import annotations

from castx.report.summary.hot_spots import MOST_ROWS, hot_spot_table

SPOT = {
    "body": "casting", "pool": 3, "parent": 1, "children": [], "merged": [], "isolated": 9.0,
    "ended": 18.18557, "place": [0.0, 0.0205], "centre": [0.01, 0.02], "volume": 2.0957e-5,
    "deficit": 1.2574e-6,
}  # fmt: skip


def test_a_row_says_where_when_and_how_much():
    table = hot_spot_table([SPOT], "axisymmetric")
    assert table.rows == [
        ("1", "casting", "3, part of 1", "9 s", "18.19 s", "0.0, 20.5", "21", "1.26")
    ]
    assert table.heading[4] == "bears" and "freezes later" in table.caption
    assert "r, z" in table.heading[5] and "cm³" in table.heading[6]
    assert "all are in" not in table.caption
    assert "`unfed_volume` of history.csv is what the shell has left of it" in table.caption


def test_what_is_unknown_is_said():
    spot = {**SPOT, "parent": None, "ended": None, "deficit": None, "place": [0.1, 0.2, 0.3]}
    (row,) = hot_spot_table([spot], "3d").rows
    assert row[2] == "3" and row[4] == "not yet" and row[7] == "unknown"
    assert row[5] == "100.0, 200.0, 300.0"


def test_volumes_in_the_plane_are_areas():
    table = hot_spot_table([SPOT], "generalised-plane-strain")
    assert "cm²" in table.heading[6] and table.rows[0][6] == "0.21"


def test_only_the_first_ones_are_shown():
    table = hot_spot_table([SPOT] * (MOST_ROWS + 2), "plane-strain")
    assert len(table.rows) == MOST_ROWS
    assert f"of {MOST_ROWS + 2}" in table.caption


def test_without_hot_spots_there_are_no_rows():
    assert not hot_spot_table([], "3d").rows
