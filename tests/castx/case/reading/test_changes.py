"""A run goes on with what does not change its past, and names what does."""

import pytest

from castx.case.reading.changes import refuse_changes
from castx.errors import CaseError
from tests.castx.case_data import REMOVED, cylinder

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"time__end": "200 s"},
        {"time__smallest_step": 1e-6},
        {"output__every": 1.0, "output__fields": ["temperature"], "output__folder": "elsewhere"},
        {"probes": []},
        {"solver__linear": "direct", "coupling__passes": 80, "name": "other"},
    ],
)
def test_allowed_changes(changes):
    refuse_changes(cylinder(), cylinder(**changes), "state.npz")


def test_a_table_may_come_and_go_with_keys_that_may_change():
    with_passes, without = cylinder(coupling={"passes": 80}), cylinder()
    without.pop("coupling", None)
    refuse_changes(without, with_passes, "state.npz")
    refuse_changes(with_passes, without, "state.npz")
    with pytest.raises(CaseError, match=r'coupling.scheme = "thermal" \(it was absent\)'):
        refuse_changes(without, cylinder(coupling={"scheme": "thermal"}), "state.npz")
    without.pop("output", None)
    with pytest.raises(CaseError, match=r'output.format = "vtu" \(it was absent\)'):
        refuse_changes(without, cylinder(output={"format": "vtu"}), "state.npz")


@pytest.mark.parametrize(
    "changes, text",
    [
        ({"bodies__0__temperature": 680}, r"bodies\[0\].temperature = 680 \(it was 670\)"),
        ({"materials__steel__density": REMOVED}, r"materials.steel.density = absent \(it was"),
        ({"geometry__floor": "5 mm"}, r'geometry.floor = "5 mm" \(it was absent\)'),
        ({"time__first_step": 1.0}, "time.first_step = 1.0"),
        ({"boundaries": []}, r"boundaries\[0\] = absent .*\n.*boundaries\[1\] = absent"),
        ({"output__format": "vtu"}, r'output.format = "vtu" \(it was absent\)'),
        ({"loads__gravity": [0, 0, -1.6]}, r"loads.gravity = \[0, 0, -1.6\]"),
    ],
)
def test_changes_of_the_model_are_refused(changes, text):
    with pytest.raises(CaseError, match=text) as refusal:
        refuse_changes(cylinder(), cylinder(**changes, time__end=1), "state.npz")
    assert "time.end =" not in str(refusal.value)
    assert "only; undo the others, or run the case anew without --restart" in str(refusal.value)
