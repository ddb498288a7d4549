"""The case as a whole: frozen, the same on all ranks, and known by its content."""

import pickle
from pathlib import Path

import pytest

from castx.case.case import Case
from castx.input.problems import Refusal
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")


@pytest.fixture
def case():
    content = cylinder()
    return Case.read(content).with_source(FILE, content)


def test_a_case_travels_between_ranks(case):
    copy = pickle.loads(pickle.dumps(case))
    assert (copy.digest, copy.path, copy.time, copy.loads) == (
        case.digest,
        case.path,
        case.time,
        case.loads,
    )
    assert copy.materials["aluminium"].conductivity.solid(340.0) == pytest.approx(223.5)


def test_a_case_is_frozen(case):
    with pytest.raises(ValueError, match="frozen"):
        case.time.end = 5.0


def test_a_source_leaves_the_case_it_is_given_to_alone(case):
    other = case.with_source(Path("other.toml"), {"name": "other"})
    assert (other.path, other.content) == (Path("other.toml"), {"name": "other"})
    assert (case.path, case.content) == (FILE, cylinder())
    assert other.digest != case.digest and other.bodies == case.bodies


def test_the_digest_is_that_of_the_content_in_any_order(case):
    content = cylinder()
    turned = dict(reversed(content.items()))
    assert list(turned) != list(content)
    assert case.with_source(FILE, turned).digest == case.digest


@pytest.mark.parametrize(
    "changes, text",
    [
        ({"name": "x" * 201}, "name: a text in quotes of at most 200 characters"),
        ({"name": "two\nlines"}, "name: a text in quotes"),
        ({"bodies": []}, "bodies: at least 1 needed"),
        ({"bodies": cylinder()["bodies"] * 51}, "bodies: at most 100 allowed"),
        ({"speed": 3}, "speed: unknown key; known keys: name, geometry"),
    ],
)
def test_refused(changes, text):
    with pytest.raises(Refusal, match=text):
        Case.read(cylinder(**changes))
