"""What a run writes."""

import pytest

from castx.case.output import FIELDS, Output, Probe
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial

PROBE = {"name": "centre", "body": "casting", "at": [0, "50 mm"], "quantities": ["temperature"]}


def test_output():
    output = Output.read({"every": "5 s", "fields": list(FIELDS)})
    assert output.every == 5.0 and output.fields == FIELDS


def test_gap_and_solidification_time_are_written_at_events_unless_others_are_asked_for():
    output = Output.read({})
    assert {"temperature", "gap", "solidification_time"} <= set(output.fields)
    assert output.every is None


def test_probe():
    probe = Probe.read(PROBE)
    assert (probe.body, probe.interface, probe.quantities) == ("casting", None, ("temperature",))
    assert probe.at == pytest.approx((0.0, 0.05))


@pytest.mark.parametrize(
    "keys, text",
    [
        ({"folder": 3}, "folder: the path of a folder is needed"),
        ({"folder": " "}, "folder: the path of a folder is needed"),
        ({"folder": "a\0b"}, "folder: the path of a folder is needed"),
        ({"every": 0}, r"every: must be positive \(in s\)"),
        ({"every": "5 mm"}, "every: 'mm' is not a unit of time"),
        ({"fields": "gap"}, "fields: a list is needed"),
        ({"fields": ["temprature"]}, r'fields\[0\]: unknown.*mean "temperature"\?'),
        ({"fields": ["gap", "gap"]}, r"fields\[1\]: is there already"),
        ({"checkpoint": 0}, r"checkpoint: must be positive \(in s\)"),
    ],
)
def test_refused_output(keys, text):
    with pytest.raises(Refusal, match=text):
        Output.read(keys)


@pytest.mark.parametrize(
    "keys, text",
    [
        ({"name": "a.b"}, "name: a name has"),
        ({"interface": "casting/mould"}, "a probe sits either on a body or on an interface"),
        ({"depth": 0.002}, 'needs the surface from which it is measured: below = "casting/mould"'),
        ({"below": "casting/top", "depth": -1e-3}, "depth: must be .*at least 0"),
        (
            {"body": None, "interface": "a/b", "below": "a/b", "quantities": ["gap"]},
            "below: needs the body into which the depth goes",
        ),
        ({"at": [0]}, "at: at least 2 needed, there are 1"),
        ({"at": [0, 0, 0, 0]}, "at: at most 3 allowed"),
        ({"at": 0}, "at: a list is needed"),
        ({"at": [0, "5 s"]}, r"at\[1\]: 's' is not a unit of length"),
        ({"quantities": []}, "quantities: at least 1 needed"),
        ({"quantities": ["gap"]}, r"quantities\[0\]: unknown quantity of a body; allowed: displ"),
        ({"quantities": ["presure"]}, r'quantities\[0\].*did you mean "pressure"\?'),
        ({"quantities": ["gap", "gap"]}, r"quantities\[0\]: unknown"),
        ({"quantities": ["stress", "stress"]}, r"quantities\[1\]: is there already"),
    ],
)
def test_refused_probe(keys, text):
    with pytest.raises(Refusal, match=text):
        Probe.read({**PROBE, **keys})


def test_an_interface_has_its_own_quantities():
    on_interface = {"name": "gap", "interface": "casting/mould", "at": [0.03, 0.05]}
    quantities = ["gap", "contact_pressure", "heat_transfer_coefficient"]
    assert Probe.read({**on_interface, "quantities": quantities}).interface == "casting/mould"
    with pytest.raises(Refusal, match=r"quantities\[0\]: unknown quantity of an interface"):
        Probe.read({**on_interface, "quantities": ["temperature"]})
