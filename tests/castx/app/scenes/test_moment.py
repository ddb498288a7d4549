"""The scene of the last moment shows the fields that were written then."""

import numpy as np
import pytest

from castx.app.scenes import moment as module
from castx.app.scenes.moment import limits_of, moment_scene, surface_values
from castx.report.packing import unpacked
from castx.report.topics import topics_of
from tests.castx.report.test_browser_scene import body, results

pytestmark = pytest.mark.serial


@pytest.fixture
def run(monkeypatch):
    """A run of two bodies, of which the mould is taken away at the end if at all."""

    def given(**changes):
        monkeypatch.setattr(module, "Results", lambda folder: results(**changes))

    return given


def test_the_last_moment_is_shown_in_the_field_that_is_asked_for(run):
    run(removed_at=9.0)
    found = moment_scene("folder", "von_mises")
    assert found["time"] == 2.0 and found["field"] == "von_mises" and not found["flat"]
    assert {field["name"] for field in found["fields"]} == {"temperature", "von_mises"}
    assert found["bodies"] == ["casting", "mould"] and found["freezing"] == ["casting"]
    counts, values = unpacked(found["counts"]), unpacked(found["values"])
    # surfaces of 3 x 2 x 2 and 2 x 2 x 2 cells, two triangles each
    assert counts.tolist() == [2 * 32, 2 * 24] and values.size == 3 * counts.sum()
    assert unpacked(found["points"]).size == 3 * values.size
    assert found["colours"] in found["maps"]


def test_another_field_is_shown_where_the_wanted_one_is_not_written(run):
    run()
    found = moment_scene("folder", "gap")
    assert found["field"] == "temperature" and found["bodies"] == ["casting"]
    values = unpacked(found["values"])
    assert (values.min(), values.max()) == (580.0, 583.0) and found["limits"] == (580.0, 583.0)


def test_colours_end_at_the_values_of_the_casting(run):
    grids = {"casting": body(1.0, 0.0), "mould": body(50.0, 0.0)}
    (topic,) = topics_of(["temperature"])
    assert limits_of(grids, topic, ["casting"]) == (590.0, 593.0)
    assert limits_of(grids, topic, []) == (100.0, 593.0)
    grids["casting"]["temperature"][:] = 20.0
    assert limits_of(grids, topic, ["casting"]) == (19.5, 20.5)


def test_a_body_without_the_field_has_no_colour():
    (topic,) = topics_of(["gap"])
    points, values = surface_values(body(0.0, 0.0), topic)
    assert points.shape == (64, 3, 3) and np.all(values > 3e38)
