"""The table [optimise]: limits, and numbers without a range."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.optimise import AnswerLimit, Optimise

pytestmark = pytest.mark.serial

ONE = {"of": "time.end", "low": 1, "high": 2}


@pytest.mark.parametrize(
    ("limit", "value", "excess"),
    [
        ({"most": 4.0}, 5.0, 0.25),
        ({"most": 4.0}, 3.0, 0.0),
        ({"least": 2.0}, 1.0, 0.5),
        ({"least": 1.0, "most": 2.0}, 1.5, 0.0),
        ({"most": 0.0}, 3.0, 3.0),
    ],
)
def test_excess_is_relative_to_the_limit(limit, value, excess):
    assert AnswerLimit.read({"of": "a", **limit}).excess(value) == pytest.approx(excess)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"inputs": []}, r"at least one \[\[optimise.inputs\]\]"),
        ({"inputs": [ONE, ONE]}, "is varied already"),
        ({"inputs": [{"of": "a", "mean": 1, "deviation": 1, "distribution": "normal"}]}, "low and"),
        ({"limits": [{"of": "a"}]}, "least or most is needed"),
        ({"limits": [{"of": "a", "least": 2, "most": 1}]}, "must not be above most"),
        ({"direction": "lowest"}, "allowed: least, most"),
        ({"runs": 6}, 'runs.*: at least 7, .* with 1 inputs; or method = "nelder-mead"'),
        ({"goal": ""}, "at least 1 needed|goal"),
    ],
)
def test_what_is_wrong_is_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        Optimise.read({"goal": "a", "inputs": [ONE], **keys})
