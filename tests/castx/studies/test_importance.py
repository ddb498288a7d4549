"""What matters, in words."""

import numpy as np
import pytest

from castx.studies.importance import importance
from castx.studies.runs.answers import RunAnswer
from castx.studies.sampling import latin_hypercube, morris_paths, saltelli_points
from castx.studies.table import StudyTable
from tests.castx.studies.test_table import kept

pytestmark = pytest.mark.serial


def of(points, result, method):
    found = [{} if np.isnan(y) else {"t": RunAnswer("t", y, "s", 1.0)} for y in result]
    runs = [kept(k) for k in range(len(points))]
    (one,) = importance(StudyTable(["a", "b", "c"], [""] * 3, points, runs, found), points, method)
    return one


def model(points):
    return 10.0 + points @ np.array([1.0, -4.0, 0.001])


@pytest.mark.parametrize(
    ("points", "method"),
    [
        (latin_hypercube(3, 20, 0), "latin-hypercube"),
        (morris_paths(3, 5, 0), "morris"),
        (saltelli_points(3, 64, 0), "sobol"),
    ],
)
def test_inputs_are_ranked(points, method):
    one = of(points, model(points), method)
    assert [effect.name for effect in one.effects] == ["b", "a", "c"]
    assert one.effects[0].change == pytest.approx(-4.0) and one.remark == ""
    known = " (-4 s)" if method != "sobol" else " ("
    assert f"it hangs on b{known}" in one.sentence and "then a (+" in one.sentence
    assert "c matters little." in one.sentence or "then c" in one.sentence
    assert f"between {model(points).min():.4g} and {model(points).max():.4g} s" in one.sentence
    assert one.as_json()["effects"][1]["name"] == "a"


def test_what_the_numbers_do_not_tell_is_said():
    points = latin_hypercube(3, 30, 0)
    bent = (points[:, 0] - 0.5) ** 2
    bent[4] = np.nan
    one = of(points, bent, "latin-hypercube")
    assert "Straight lines explain" in one.remark and "1 of 30 runs" in one.remark
    few = of(points[:4], points[:4, 0], "latin-hypercube")
    assert "too few runs" in few.remark and few.as_json()["effects"][0]["change"] is None
