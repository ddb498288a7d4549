"""Places where a thermocouple might lie."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.candidates import CandidateSensor

pytestmark = pytest.mark.serial

BELOW = {
    "name": "a", "body": "mould", "below": "casting/mould", "depth": "2 mm",
    "at": ["30 mm", "0.5 mm"],
}  # fmt: skip
FREE = {"name": "b", "body": "casting", "at": ["10 mm", "0 mm"], "direction": [3, 4]}


def test_its_probes_lie_there_and_deeper():
    here, deeper = CandidateSensor.read(BELOW).probes(1e-4)
    assert (here["name"], here["depth"]) == ("a", 2e-3)
    assert (deeper["name"], deeper["depth"]) == ("a deeper", pytest.approx(2.1e-3))
    here, deeper = CandidateSensor.read(FREE).probes(1e-4)
    assert here["at"] == [0.01, 0.0] and "below" not in here
    assert deeper["at"] == pytest.approx([0.01006, 8e-5])


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({**FREE, "direction": None}, 'there is no "below"'),
        ({**FREE, "depth": "1 mm"}, "needs the surface"),
        ({**FREE, "direction": [1, 0, 0]}, "direction.*: needs as many numbers as at, 2"),
        ({**BELOW, "noise": 0}, "positive"),
    ],
)
def test_what_is_wrong_is_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        CandidateSensor.read({key: value for key, value in keys.items() if value is not None})
