"""A body at a moment: chosen, with its fields, and what is missing named with its cure."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.handover.body_state import BodyState
from tests.castx.handover.made_results import box, made

pytestmark = pytest.mark.serial


@pytest.fixture
def state(tmp_path):
    points, cells = box(4)
    nodal = {"temperature": 100.0 * points[:, 0], "displacement": 1e-3 * points}
    return made(tmp_path / "out", "3d", points, cells, nodal, {"stress": np.ones((len(cells), 6))})


def test_mesh_and_fields_are_those_of_the_files(state):
    points, cells = box(4)
    np.testing.assert_allclose(state.points, points, atol=1e-15)
    np.testing.assert_array_equal(state.cells, cells)
    np.testing.assert_allclose(state.displacement, 1e-3 * points)
    np.testing.assert_allclose(state.in_cells("temperature"), 100.0 * points[cells, 0].mean(axis=1))
    np.testing.assert_array_equal(state.in_cells("stress"), np.ones((len(cells), 6)))
    assert state.moment == 5.0


def test_the_body_that_freezes_and_the_end_of_a_stage_are_chosen(state):
    assert BodyState.chosen(state.results).name == "casting"
    assert BodyState.chosen(state.results, stage=1).time == 5.0


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ({"body": "castin"}, 'did you mean "casting"'),
        ({"stage": 3}, "no stage 3 has ended; stages that have: 1"),
        ({"stage": 1, "time": 5.0}, "leave one out"),
        ({"time": 4.0}, "no fields were written at 4 s"),
    ],
)
def test_what_is_not_there_is_refused(state, chosen, message):
    with pytest.raises(CaseError, match=message):
        BodyState.chosen(state.results, **chosen)


def test_a_missing_field_is_named_with_the_line_of_the_case(state):
    state.need(["stress"], "this")
    with pytest.raises(CaseError) as refused:
        state.need(["stress", "passing_time_0.0", "arm_spacing"], "the table")
    text = str(refused.value)
    assert text.startswith("passing_time_0.0, arm_spacing of 'casting'")
    assert 'fields = ["temperature", "solid_fraction", "displacement", "von_mises", ' in text
    assert text.endswith('"passing_times", "arm_spacing"]')


@pytest.mark.parametrize("content", ["{", "[]", "[" * 100_000])
def test_a_damaged_case_is_named(state, content):
    (state.results.folder / "case.json").write_text(content)
    with pytest.raises(CaseError, match=r"case\.json: .*; put a whole copy there"):
        _ = state.case
