"""The largest suctions over a run."""

import numpy as np
import pytest

from castx.report.summary.suctions import TOLD, suctions
from castx.results.files.run_tables import Columns
from tests.castx.report.summary.fake_run import TIME, run

pytestmark = pytest.mark.serial


def suction(melt, wall):
    columns = {"casting.melt_suction": np.array(melt), "casting/mould.suction": np.array(wall)}
    columns["casting.solid_fraction"] = np.array([0.0, 0.6, 1.0, 1.0])
    return list(suctions(run(history=Columns({"time": TIME} | columns))))


def test_the_largest_suctions_count_with_their_times():
    melt, wall = suction([0.0, 5e4, 2e4, 0.0], [0.0, 1e3, 2e5, 0.0])
    assert (melt.of, melt.number, melt.time) == ("casting", "50 kPa", 1.0)
    assert (wall.of, wall.number, wall.time) == ("casting/mould", "200 kPa", 2.0)
    assert melt.shown.field == "melt_suction" and wall.shown.field == "wall_suction"
    assert wall.shown.bodies == ("casting",)


def test_pulls_of_solid_metal_are_no_suction():
    """The casting is solid from the end of the third step on; its twin stays liquid."""
    (_, wall) = suction([0.0, 5e4, 0.0, 0.0], [0.0, 2e3, 0.0, 4e6])
    assert (wall.number, wall.time) == ("2 kPa", 1.0)
    assert len(suction([0.0, 5e4, 0.0, 0.0], [0.0, 0.0, 0.0, 4e6])) == 1
    columns = {"time": TIME, "casting/twin.suction": np.array([0.0, 2e3, 0.0, 4e6])}
    columns |= {f"{body}.solid_fraction": TIME / n for body, n in (("casting", 2), ("twin", 4))}
    both = {"interfaces": ("casting/twin",), "history": Columns(columns)}
    (wall,) = suctions(run(**both | {"freezing": ["casting", "twin"]}))
    assert (wall.number, wall.time) == ("4000 kPa", 3.0)


def test_more_than_a_vacuum_is_said():
    melt, wall = suction([0.0, 1.01e5, 0.0, 0.0], [0.0, 6.23e5, 0.0, 0.0])
    assert "more than a vacuum" not in melt.sentence
    assert "more than a vacuum" in wall.sentence


def test_halves_of_a_mould_that_pull_each_other_are_no_suction_of_metal():
    columns = {"time": TIME, "die-low/die-high.suction": np.array([0.0, 1e6, 0.0, 0.0])}
    changed = {"interfaces": ("die-low/die-high",), "history": Columns(columns)}
    assert list(suctions(run(**changed))) == []
    assert len(list(suctions(run(**changed | {"freezing": ["die-high"]})))) == 1


def test_the_wall_that_pulls_most_comes_first():
    pulls = {"casting/chill": 9e5, "casting/core": 4e4, "casting/mould": 8e7}
    columns = {f"{name}.suction": np.array([0.0, pull, 0.0, 0.0]) for name, pull in pulls.items()}
    history = Columns({"time": TIME} | columns)
    found = list(suctions(run(history=history, interfaces=tuple(pulls))))
    assert [wall.of for wall in found] == ["casting/mould", "casting/chill", "casting/core"]


def test_small_suctions_are_left_out():
    assert not suction([0.0, 0.99 * TOLD, 0.0, 0.0], [0.0, 0.0, 0.99 * TOLD, 0.0])
    assert not list(suctions(run()))
