"""The table [vary]: numbers of runs, and contradictions."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.vary import Vary

pytestmark = pytest.mark.serial

ONE = {"of": "time.end", "low": 1, "high": 2}
TWO = {"of": "bodies.0.temperature", "low": 650, "high": 700}


@pytest.mark.parametrize(
    ("keys", "runs"),
    [
        ({}, 32),
        ({"method": "morris"}, 30),
        ({"method": "sobol", "draws": 8}, 32),
        ({"method": "grid"}, 9),
        ({"method": "grid", "inputs": [{**ONE, "points": 5}, {"of": "a", "values": [1, 2]}]}, 10),
    ],
)
def test_number_of_runs(keys, runs):
    assert Vary.read({"inputs": [ONE, TWO], **keys}).number_of_runs == runs


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"inputs": []}, "at least one"),
        ({"inputs": [ONE, ONE]}, "is varied already"),
        ({"inputs": [{**ONE, "name": "a"}, {**TWO, "name": "a"}]}, "is there already"),
        ({"inputs": [{"of": "a", "values": [1, 2]}]}, "low: missing|grid"),
        ({"method": "grid", "draws": 3}, "a grid has none"),
        ({"method": "sobol", "draws": 100}, "such as 64 or 128"),
        ({"method": "montecarlo"}, "allowed: grid, latin-hypercube, morris, sobol"),
        ({"draws": 1}, "from 2 to"),
        ({"method": "sobol", "draws": 65536}, "at most 100000"),
    ],
)
def test_contradictions_are_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        Vary.read({"inputs": [ONE, TWO], **keys})
