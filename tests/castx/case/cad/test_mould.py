"""A mould as a case file has it."""

from __future__ import annotations

import pytest

from castx.case.cad.mould import CadMould, plane, symmetry_planes
from castx.errors import CaseError
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial

LINE = [[0, 0, 0], ["10 mm", 0, 0]]


def test_units_and_defaults():
    mould = CadMould.read(
        {
            "box": "40 mm",
            "split": "z = 10 mm",
            "cores": ["core"],
            "cooling": [{"line": LINE, "diameter": "1 cm"}],
            "chills": [{"name": "chill", "box": [[0, 0, 0], [1, 1, 1]]},
                       {"name": "pin", "line": LINE, "diameter": 0.5}],
        }
    )  # fmt: skip
    assert (mould.name, mould.box, mould.split) == ("mould", 0.04, (2, 0.01))
    (channel,) = mould.cooling
    assert channel.name == "cooling" and channel.line == ((0, 0, 0), (0.01, 0, 0))
    assert [chill.diameter for chill in mould.chills] == [None, 0.5]
    assert CadMould.read({"box": [[0, 0, 0], [1, 1, 1]]}).box == ((0, 0, 0), (1, 1, 1))
    shell = CadMould.read({"shell": "8 mm"})
    assert (shell.box, shell.shell) == (None, 0.008)
    assert CadMould.read({"box": "2 cm", "shell": "8 mm"}).box == 0.02


def test_planes():
    assert plane("x < -3 cm", ("<", ">")) == (0, "<", pytest.approx(-0.03))
    assert symmetry_planes(["x > 0", "y < 1 mm"]) == ((0, 0.0, True), (1, 0.001, False))
    for wrong in ("x", "x = 0 s", "w = 0", "x > 0", 3):
        with pytest.raises(CaseError):
            plane(wrong, ("=",))
    with pytest.raises(CaseError, match="a list of 1 to 3 planes"):
        symmetry_planes("x > 0")
    with pytest.raises(Refusal, match="has a plane already"):
        symmetry_planes(["x > 0", "x < 1"])


@pytest.mark.parametrize(
    "description, text",
    [
        ({}, 'box: missing; a block, box = "40 mm", or a shell, shell = "8 mm"'),
        ({"box": 0}, "box: must be positive"),
        ({"box": 1, "split": "z"}, 'split: a plane across x, y or z is needed: "z = 10 mm"'),
        ({"box": 1, "cooling": [{"line": LINE}]}, r"cooling\[0\].diameter: missing"),
        (
            {"box": 1, "cooling": [{"line": [LINE[0]], "diameter": 1}]},
            r"cooling\[0\].line: a line is needed",
        ),
        (
            {"box": 1, "cooling": [{"line": [LINE[0], LINE[0]], "diameter": 1}]},
            r"cooling\[0\].line\[1\]: is the corner before again",
        ),
        ({"box": 1, "cooling": [{"line": [[0, 0], LINE[0]], "diameter": 1}]}, r"line\[0\]: three"),
        ({"box": 1, "chills": [{"name": "a"}]}, r"chills\[0\]: give either box, or line"),
        ({"box": 1, "chills": [{"name": "a", "line": LINE}]}, "a cylinder needs line"),
        (
            {"box": 1, "chills": [{"name": "a", "box": [[0, 0, 0], [1, 1, 1]], "diameter": 1}]},
            r"chills\[0\].diameter: a box has none",
        ),
        (
            {"box": 1, "chills": [{"name": "mould", "box": [[0, 0, 0], [1, 1, 1]]}]},
            r"chills\[0\].name: is there already; names: mould",
        ),
        ({"shell": 0}, "shell: must be positive"),
        ({"box": "8 mm", "shell": "8 mm"}, "box: must exceed shell, 0.008 m; left out it has room"),
        (
            {"shell": 1, "cooling": [{"line": LINE, "diameter": 1}]},
            "cooling: a shell has no channels; leave them or the shell out",
        ),
        ({"box": 1, "plug": "mould"}, "plug: is a name of the mould; names: mould$"),
        ({"box": 1, "split": "z = 0", "plug": "mould-low"}, "plug: is a name of the mould"),
        (
            {"box": 1, "plug": "p", "chills": [{"name": "p", "box": [[0, 0, 0], [1, 1, 1]]}]},
            r"chills\[0\].name: is there already",
        ),
    ],
)
def test_refused(description, text):
    with pytest.raises(Refusal, match=text):
        CadMould.read(description)
