"""Declarations with numbers: doubles, what is missing, what is chosen."""

from dataclasses import dataclass

import pytest

from castx.errors import CaseError
from castx.input.numbered import by_number, chosen_from

pytestmark = pytest.mark.serial


@dataclass
class Check:
    number: str
    title: str = "a check"


BOTH = {one.number: one for one in (Check("C1"), Check("C2"))}


def test_the_order_is_that_in_which_they_come():
    assert list(by_number("check", [Check("C2"), Check("C1")], ("title",))) == ["C2", "C1"]


def test_a_double_and_one_that_says_too_little_are_refused():
    with pytest.raises(TypeError, match="check C1 stands in two files"):
        by_number("check", [Check("C1"), Check("C1")], ())
    with pytest.raises(TypeError, match="check C1 declares no title"):
        by_number("check", [Check("C1", "")], ("title",))


def test_numbers_choose_in_any_spelling_and_in_the_known_order():
    assert chosen_from("check", BOTH, ["c2", "C1"]) == list(BOTH.values())
    assert chosen_from("check", BOTH, ["C2"]) == [BOTH["C2"]]
    assert chosen_from("check", BOTH, []) == list(BOTH.values())
    with pytest.raises(CaseError, match="there is no check 'C9'"):
        chosen_from("check", BOTH, ["C1", "C9"])
