"""Refusals of the commands: in their words, on all ranks, with the file in front."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.command.refusals import naming, seconds
from castx.errors import CaseError, ConvergenceError, MeshError


@pytest.mark.parametrize(("text", "value"), [("90", 90.0), ("8 h", 28800.0), ("1.5 min", 90.0)])
def test_a_time_is_a_number_or_has_a_unit(text, value):
    assert seconds("--time-limit", text) == value


@pytest.mark.parametrize("text", ["soon", "-5", "0", "3 kg", "nan"])
def test_what_is_no_time_is_refused_with_its_option(text):
    with pytest.raises(CaseError, match=rf'--time-limit {text}: .*for instance "8 h"'):
        seconds("--time-limit", text)


@pytest.mark.parametrize("kind", [CaseError, MeshError])
def test_the_file_stands_in_front_once(kind):
    with pytest.raises(kind, match=r"^a\.toml: wrong$"), naming(Path("a.toml")):
        raise kind("wrong")
    with pytest.raises(kind, match=r"^in a\.toml$"), naming(Path("a.toml")):
        raise kind("in a.toml")


def test_other_errors_pass_as_they_are():
    with pytest.raises(ConvergenceError, match="no step"), naming(Path("a")):
        raise ConvergenceError("no step")
