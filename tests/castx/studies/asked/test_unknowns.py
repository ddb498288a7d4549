"""Unknowns: numbers and tables, bounds that are none."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.unknowns import SoughtNumber

pytestmark = pytest.mark.serial

ONE = {"of": "interfaces.0.heat.closed", "name": "h"}
TABLE = {**ONE, "over": "time", "knots": ["0 s", "1 s", "5 s"]}


def test_a_number_and_a_table():
    one = SoughtNumber.read({**ONE, "start": "900 W/m^2/K"})
    assert not one.is_table and one.given_unit == "W/m^2/K"
    table = SoughtNumber.read({**TABLE, "start": [3, 2, 1], "smoothness": 0.5})
    assert table.is_table and [amount.value for amount in table.start] == [3.0, 2.0, 1.0]


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({**ONE, "over": "time"}, "a table needs both over and knots"),
        ({**ONE, "knots": [1, 2]}, "a table needs both over and knots"),
        ({**TABLE, "knots": [1]}, "at least two"),
        ({**TABLE, "knots": [1, 1, 2]}, "must rise"),
        ({**TABLE, "knots": ["1 s", 2, 3]}, "same unit"),
        ({**TABLE, "start": [1, 2]}, "one for each of 3 knots"),
        ({**ONE, "start": []}, "start.*: one number is needed, there are 0"),
        ({**ONE, "start": [1, 2]}, "start.*: one number is needed, there are 2"),
        ({**TABLE, "start": []}, "one for each of 3 knots is needed, there are 0"),
        ({**ONE, "difference": 1.5}, "difference.*: is one of ln: at most 1"),
        (
            {**ONE, "scale": "linear", "low": 1, "high": 2, "difference": 1},
            "must be smaller than that of low and high",
        ),
        ({**TABLE, "knots": [1, 2], "smoothness": 1}, "at least three knots"),
        ({**TABLE, "over": "depth"}, "allowed: time, gap, temperature, pressure"),
        ({**ONE, "low": 2, "high": 1}, "must lie below high = 1; exchange them"),
        ({**ONE, "low": 2, "start": 2}, "must lie above low = 2"),
        ({**ONE, "high": 2, "start": 3}, "must lie below high = 2"),
        ({**ONE, "low": 0}, 'or scale = "linear"'),
        ({**ONE, "start": -1}, 'or scale = "linear"'),
        ({**ONE, "start": "1 mm", "low": 0.1}, "same unit"),
        ({**ONE, "deviation": 0}, "positive"),
        ({"of": "a"}, "name: missing"),
    ],
)
def test_what_is_wrong_is_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        SoughtNumber.read(keys)


def test_a_linear_one_may_be_negative():
    assert SoughtNumber.read({**ONE, "scale": "linear", "low": -1, "start": 0}).low.value == -1.0
