from dataclasses import replace

import pytest

from castx.errors import CaseError
from castx.proof.verification.registry import VERIFICATIONS, chosen, ordered

pytestmark = pytest.mark.serial


def test_numbers_are_in_order():
    letters = [number[0] for number in VERIFICATIONS]
    assert letters == sorted(letters, reverse=True)
    numbers = [int(number[1:]) for number in VERIFICATIONS if number[0] == "V"]
    assert numbers == sorted(numbers) and numbers[0] == 1


def test_levels_become_finer_and_say_what_falls():
    for verification in VERIFICATIONS.values():
        for levels in (verification.levels, verification.quick):
            sizes = [verification.measure(level) for level in levels]
            assert sizes == sorted(sizes, reverse=True) and len(set(sizes)) == len(sizes)
            if verification.refined != "nothing":
                assert len(sizes) > 1 and verification.norm


def test_some_are_chosen_in_any_spelling_and_without_choice_all():
    assert [v.number for v in chosen(["v9", "V1"])] == ["V1", "V9"]
    assert [v.number for v in chosen([])] == list(VERIFICATIONS)
    with pytest.raises(CaseError, match="no verification 'V999'"):
        chosen(["V1", "V999"])


def test_a_number_that_stands_twice_or_a_missing_source_is_refused():
    one = VERIFICATIONS["V1"]
    with pytest.raises(TypeError, match="V1 stands in two files"):
        ordered([one, one])
    with pytest.raises(TypeError, match="declares no source"):
        ordered([replace(one, source="")])
