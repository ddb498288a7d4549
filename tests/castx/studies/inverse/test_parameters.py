"""Unknowns as numbers of a fit, and back as values of the case."""

import numpy as np
import pytest

from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.foundry.identification.smoothness import second_differences
from castx.studies.asked.unknowns import SoughtNumber
from castx.studies.inverse.parameters import BETWEEN, Parameters, SoughtValues
from castx.studies.runs.runner import changes_as_overrides
from tests.castx.many_runs import CASE

pytestmark = pytest.mark.serial

CLOSED = "interfaces.0.heat.closed"


@pytest.fixture
def content(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return load_case(path).content


def sought(content, **keys):
    return SoughtValues.of(SoughtNumber.read({"of": CLOSED, "name": "h", **keys}), content)


def test_a_number_begins_with_that_of_the_case_in_its_unit(content):
    one = sought(content)
    (unknown,) = one.unknowns()
    assert (unknown.start, unknown.positive, unknown.difference) == (2000.0, True, 0.01)
    assert one.change({"h": 1234.5}) == "1234.5 W/m^2/K"
    other = sought(content, low="1 kW/m^2/K", high="4 kW/m^2/K")
    (unknown,) = other.unknowns()
    assert unknown.start == pytest.approx(2.0) and unknown.bounds[1] == pytest.approx(np.log(4.0))


def test_a_linear_number(content):
    one = sought(content, of="materials.die.conductivity", scale="linear", deviation=2.0)
    (unknown,) = one.unknowns()
    assert (unknown.start, unknown.positive, unknown.deviation) == (35.0, False, 2.0)
    assert unknown.difference == pytest.approx(0.2)


def test_a_table_is_linear_in_ln_between_its_knots(content):
    one = sought(content, over="time", knots=["0 s", "1 s", "4 s"])
    assert one.names == ["h at 0 s", "h at 1 s", "h at 4 s"]
    change = one.change({"h at 0 s": 1000.0, "h at 1 s": 4000.0, "h at 4 s": 500.0})
    assert change["over"] == "time" and len(change["table"]) == 2 * BETWEEN + 1
    rows = {row[0]: float(row[1].split()[0]) for row in change["table"]}
    assert rows["0.5 s"] == pytest.approx(2000.0)  # the geometric mean
    assert rows["4.0 s"] == pytest.approx(500.0)
    case = load_case({**content}, changes_as_overrides({CLOSED: change}))
    assert case.content["interfaces"][0]["heat"]["closed"]["over"] == "time"


def test_a_table_of_the_case_is_met_at_the_knots(content):
    content["interfaces"][0]["heat"]["closed"] = {"over": "time", "table": [[0, 1e3], [10, 2e3]]}
    one = sought(content, over="time", knots=[2, 8])
    assert one.start.tolist() == [1200.0, 1800.0]
    assert one.names == ["h at 2 s", "h at 8 s"] and one.shown_unit == "W/m²/K"
    assert sought(content, start="1 kW/m^2/K").shown_unit == "kW/m^2/K"
    content["materials"]["die"]["conductivity"] = [["0 degC", 30], ["400 degC", 34]]
    plain = sought(
        content, of="materials.die.conductivity", over="temperature", knots=["100 degC", "300 degC"]
    )
    assert plain.start.tolist() == [31.0, 33.0]
    change = plain.change(dict(zip(plain.names, [30.0, 40.0], strict=True)))
    assert change[0] == ["100.0 degC", pytest.approx(30.0)] and change[-1] == [
        "300.0 degC",
        pytest.approx(40.0),
    ]


def test_a_table_along_a_face(content):
    """Begins with that of the case, or with one number in place of a formula."""
    of = "boundaries.0.heat.value"
    along = {"along": "x", "table": [[0, "40 kW/m^2"], ["50 mm", "60 kW/m^2"]]}
    content["boundaries"] = [{"on": "mould/outside", "heat": {"type": "flux", "value": along}}]
    keys = {"of": of, "over": "x", "knots": ["0 mm", "25 mm"], "scale": "linear"}
    one = sought(content, **keys)
    assert one.start.tolist() == [40.0, 50.0] and one.unit == "kW/m^2"
    change = one.change(dict(zip(one.names, [10.0, 20.0], strict=True)))
    assert change["along"] == "x" and change["table"][-1] == ["25.0 mm", "20.0 kW/m^2"]
    case = load_case({**content}, changes_as_overrides({of: change}))
    (heat,) = case.boundaries[0].heat
    assert heat.given.values["value"]([[0.0125, 0.0]], 0.0) == pytest.approx([15e3])
    content["boundaries"][0]["heat"]["value"] = {"formula": "4e4 + x"}
    begun = sought(content, start=7.0, **keys)
    assert begun.change(dict(zip(begun.names, [1.0, 2.0], strict=True)))["along"] == "x"


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"of": "interfaces.0.heat.close"}, "the case has nothing at interfaces.0.heat.close"),
        ({"of": "bodies.0.name"}, r'the case has bodies.0.name = "casting": a number is needed'),
        ({"low": "3 kW/m^2/K"}, "the case has .*closed = 2 kW/m.2/K, not above low = 3: give a"),
        ({"high": "2000 W/m^2/K"}, "closed = 2000 W/m.2/K, not below high = 2000: give a start"),
        ({"low": 1.0, "high": 2.0, "of": "bodies.1.temperature"}, "write both in the same unit"),
    ],
)
def test_what_the_case_does_not_have_is_refused(content, keys, text):
    with pytest.raises(CaseError, match=text):
        sought(content, **keys)


def test_a_number_without_logarithm_is_refused(content):
    content["bodies"][1]["temperature"] = "-5 degC"
    with pytest.raises(CaseError, match='-5 degC, which has no logarithm: say scale = "linear"'):
        sought(content, of="bodies.1.temperature")
    assert sought(content, of="bodies.1.temperature", scale="linear").start.tolist() == [-5.0]


def test_smoothness_stands_in_the_columns_of_its_table(content):
    knots = [0.0, 1.0, 4.0, 9.0]
    numbers = [
        {"of": "materials.die.conductivity", "name": "k"},
        {"of": CLOSED, "name": "h", "over": "time", "knots": knots, "smoothness": 0.5},
    ]
    parameters = Parameters.of([SoughtNumber.read(one) for one in numbers], content)
    rows = parameters.smoothness(6)
    assert rows.shape == (2, 6) and not rows[:, [0, 5]].any()
    np.testing.assert_allclose(rows[:, 1:5], 2.0 * second_differences(np.array(knots)))
    gap = SoughtNumber.read({**numbers[1], "over": "gap", "knots": ["0 um", "10 um", "30 um"]})
    with pytest.raises(CaseError, match=r"W/m\^2/K"):
        Parameters.of([SoughtNumber.read({**numbers[1], "low": "1 m"})], content)
    over_gap = SoughtValues.of(gap, content)
    assert over_gap.smoothness().shape == (1, 3) and over_gap.abscissa == "gap [um]"
    assert parameters.sought[1].abscissa == "time [s]"
    along = SoughtNumber.read({**numbers[1], "over": "z", "knots": [0.0, 0.1, 0.2]})
    assert SoughtValues.of(along, content).abscissa == "z [m]"
    change = over_gap.change(dict.fromkeys(over_gap.names, 500.0))
    load_case(content, changes_as_overrides({CLOSED: change}))  # the case takes it
