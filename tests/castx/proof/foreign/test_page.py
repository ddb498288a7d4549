"""The page has all numbers of all who know them, and says what is missed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.proof.foreign.declaration import Number
from castx.proof.foreign.page import Ran, write_page
from castx.proof.foreign.registry import FOREIGN_CASES

pytestmark = pytest.mark.serial
NEAR = Number("T at the wall", 166.4, 166.44, 166.443, "°C", 1e-3, 200.0)
FAR = Number.relative("gap <wide>", None, 3e-5, 4e-5, "m", 0.01)


def test_the_page_has_the_numbers_of_all(tmp_path):
    case = replace(FOREIGN_CASES["X1"], remark="Why & how.")
    text = write_page(tmp_path / "new", [Ran(case, (NEAR, FAR), 1.25)], 2).read_text()
    numbers = ["166.4 °C", "166.44 °C", "166.443 °C", "3e-05 m", "4e-05 m", "25 %", "2 ranks"]
    words = ["code_aster", "TTLP100", "Why &amp; how.", "gap &lt;wide&gt;", "missed: X1"]
    for part in numbers + words:
        assert part in text, part
    assert text.count('<span class="verdict met">') == 1


def test_a_case_that_failed_says_why(tmp_path):
    ran = Ran(FOREIGN_CASES["X1"], (), 0.5, "no solution with the smallest step")
    assert not ran.met and ran.worst is None
    assert "no solution with the smallest step" in write_page(tmp_path, [ran], 1).read_text()


def test_the_worst_number_is_nearest_to_its_tolerance():
    ran = Ran(FOREIGN_CASES["X1"], (NEAR, FAR), 0.5)
    assert ran.worst is FAR and not ran.met and Ran(FOREIGN_CASES["X1"], (NEAR,), 0.5).met
