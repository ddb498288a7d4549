"""Cases by their numbers: order, doubles, what is missing, what is chosen."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.errors import CaseError
from castx.proof.foreign.registry import FOREIGN_CASES, chosen, ordered

pytestmark = pytest.mark.serial
CASE = FOREIGN_CASES["X1"]


def test_cases_come_in_the_order_of_their_numbers():
    tenth, second = replace(CASE, number="X10"), replace(CASE, number="X2")
    assert list(ordered([tenth, CASE, second])) == ["X1", "X2", "X10"]
    assert len(FOREIGN_CASES) == 14


def test_a_number_that_is_there_twice_is_refused():
    with pytest.raises(TypeError, match="foreign case X1 stands in two files"):
        ordered([CASE, CASE])


@pytest.mark.parametrize("key", ["title", "program", "path", "exact", "remark"])
def test_a_case_that_says_too_little_is_refused(key):
    with pytest.raises(TypeError, match=f"foreign case X1.*{key}"):
        ordered([replace(CASE, **{key: ""})])


def test_numbers_choose():
    assert [case.number for case in chosen(["x3", "X1"])] == ["X1", "X3"]
    assert len(chosen([])) == len(FOREIGN_CASES)
    with pytest.raises(CaseError, match="there is no foreign case 'X77'"):
        chosen(["X77"])
