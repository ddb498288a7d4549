"""Formulas of a case: arithmetic, and nothing else."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.input.formulas import Formula

pytestmark = pytest.mark.serial


def test_arithmetic_of_names():
    x, t = np.array([0.0, 0.5, 2.0]), np.full(3, 4.0)
    found = Formula("-2*x**2 + max(t, 5)/2 + sqrt(t)*exp(0)", ("x", "t"))
    np.testing.assert_allclose(found({"x": x, "t": t}), -2 * x**2 + 4.5)
    assert found.used == {"x", "t"}
    np.testing.assert_array_equal(Formula("2*pi", ("x",))({"x": x}), np.full(3, 2 * np.pi))


def test_what_is_not_finite_is_returned_as_such():
    assert not np.isfinite(Formula("1/x", ("x",))({"x": np.zeros(1)})).any()
    assert not np.isfinite(Formula("9.0**9**9", ("x",))({"x": np.zeros(1)})).any()


@pytest.mark.parametrize(
    "text, said",
    [
        ("", "1 to 200 characters"), ("x" * 201, "1 to 200 characters"),
        ("x +", "is no formula"), ("(" * 150, "is no formula"), ("x\0", "is no formula"),
        ("y", "'y' means nothing in a formula; known: x, pi"),
        ("sqr(x)", "formula may have"), ("x.real", "may have"), ("'a'*x", "may have"),
        ("x if x else 1", "may have"), ("x % 2", "may have"), ("True", "may have"),
        ("min(x)", "min of a formula needs 2 arguments, got 1"),
        ("__import__('os')", "may have"), ("sqrt*x", "'sqrt' means nothing"),
        ("sin(x=1)", "may have"), ("[x]", "may have"), ("1" + "0" * 150 + "e190", "large"),
    ],
)  # fmt: skip
def test_refused(text, said):
    with pytest.raises(CaseError, match=said):
        Formula(text, ("x",))


def test_deep_formulas_are_refused_or_calculated():
    assert Formula("-" * 180 + "x", ("x",))({"x": np.ones(1)})[0] == 1.0
