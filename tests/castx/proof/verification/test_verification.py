import numpy as np
import pytest

from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

pytestmark = pytest.mark.serial


def made(**changes):
    line = np.zeros(2)
    outcome = Outcome((), 0.0, Comparison("x", "y", (Curve("", line, line, line, line),)))
    numbers = {
        "number": "V99", "title": "t", "formula": "f", "source": "s", "run": lambda *_: outcome,
        "levels": (Resolution(0.2, 0.4), Resolution(0.1, 0.1)), "quick": (Resolution(0.2, 0.4),),
    }  # fmt: skip
    return Verification(**{**numbers, **changes})


def test_errors_are_shares_of_the_exact_value_or_in_a_unit():
    assert Answer.relative("p", -90.0, -100.0, "Pa", 0.2).error == pytest.approx(0.1)
    assert Answer.difference("T", 1.2, "K", 1.5).error == pytest.approx(1.2)
    assert Answer.difference("σ", -3e6, "Pa", 0.05, 40e6).error == pytest.approx(0.075)


def test_tolerances_grow_with_what_is_refined():
    coarse = Resolution(0.4, 0.8)
    assert made().allowance(coarse) == pytest.approx(4.0)
    assert made(refined="step").allowance(coarse) == pytest.approx(8.0)
    assert made().allowance(Resolution(0.05)) == 1.0
