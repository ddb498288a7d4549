"""The table [identify]: what is missing or there twice."""

from pathlib import Path

import pytest

from castx.errors import CaseError
from castx.studies.asked.identify import Identify

pytestmark = pytest.mark.serial

CURVE = {"of": "near.temperature", "file": "a.csv", "noise": "1 K"}
UNKNOWN = {"of": "interfaces.0.heat.closed", "name": "h"}


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"curves": []}, r"at least one \[\[identify.curves\]\]"),
        ({"unknowns": []}, r"at least one \[\[identify.unknowns\]\]"),
        ({"curves": [CURVE, CURVE]}, "is there already; leave one out"),
        ({"unknowns": [UNKNOWN, {**UNKNOWN, "name": "k"}]}, "is identified already"),
        ({"unknowns": [UNKNOWN, {**UNKNOWN, "of": "a"}]}, "choose another one"),
        ({"unknowns": [{**UNKNOWN, "name": "clock"}]}, "choose another one"),
        ({"clock_deviation": "-1 s"}, "positive"),
        ({"wanted": ["h", "k"]}, r"wanted\[1\].*: no unknown 'k'; known: h"),
    ],
)
def test_what_is_wrong_is_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        Identify.read({"curves": [CURVE], "unknowns": [UNKNOWN], **keys})


def test_files_are_those_beside_the_case():
    study = Identify.read({"curves": [CURVE], "unknowns": [UNKNOWN]})
    assert study.relative_to(Path("/there")).curves[0].file == Path("/there/a.csv")
