"""Shares of the variance: of a sum, where they are known, and of a product, where they are less."""

import numpy as np
import pytest

from castx.foundry.identification.lumped import LumpedCooling
from castx.foundry.identification.sobol import first_order_indices, runs

pytestmark = pytest.mark.serial

WIDTHS = {"one": (0.0, 1.0), "two": (3.0, 4.0), "three": (-0.5, 0.5)}
EXACT = [0.190476, 0.761905, 0.047619]


def weighted(inputs):
    return inputs["one"] + 2.0 * inputs["two"] + 0.5 * inputs["three"]


def test_a_sum_shares_by_the_squares_of_its_weights():
    """X1 + 2 X2 + 0.5 X3 of equal widths: 1, 4 and 0.25 parts of 5.25."""
    errors = []
    for draws in (64, 1024):
        found = first_order_indices(weighted, WIDTHS, draws)
        assert list(found) == list(WIDTHS)
        errors.append(np.abs(np.array(list(found.values())) - EXACT).max())
    assert errors[1] < 2e-3 and errors[0] > 4.0 * errors[1]


def test_what_inputs_share_together_is_left_out():
    """X1 X2 with means m and deviations 1/√12: S1 = m²/(2 m² + 1/12)."""
    bounds = {"a": (0.0, 1.0), "b": (0.0, 1.0)}
    found = first_order_indices(lambda x: x["a"] * x["b"], bounds, 1024)
    assert list(found.values()) == pytest.approx([3.0 / 7.0] * 2, abs=5e-3)


def test_inputs_of_a_cooling_body():
    """The temperature after 20 s hangs on the coefficient most, on the ambient least."""

    def temperature(inputs):
        coefficient = float(np.exp(inputs["ln h"]))
        body = LumpedCooling(2.6e4, coefficient, inputs["start"], inputs["ambient"])
        return float(body.temperature(np.array(20.0)))

    bounds = {"ln h": (np.log(300), np.log(900)), "start": (590, 610), "ambient": (95, 105)}
    found = first_order_indices(temperature, bounds, 128)
    assert found["ln h"] > 0.9 > found["start"] > found["ambient"] > -1e-3


def test_the_same_seed_gives_the_same_and_the_model_is_asked_as_often_as_said():
    asked = []

    def counted(inputs):
        asked.append(inputs)
        return weighted(inputs)

    first, second = (first_order_indices(counted, WIDTHS, 16, seed=3) for _ in range(2))
    assert first == second != first_order_indices(weighted, WIDTHS, 16, seed=4)
    assert len(asked) == 2 * runs(16, 3)
    lowest, highest = (pick([inputs["two"] for inputs in asked]) for pick in (min, max))
    assert 3.0 <= lowest < 3.1 and 3.9 < highest <= 4.0


def test_a_model_is_asked_for_256_draws_unless_told_otherwise():
    asked = []
    first_order_indices(lambda inputs: asked.append(inputs) or 5.0, WIDTHS)
    assert len(asked) == runs(256, 3)


def test_what_does_not_change_hangs_on_nothing():
    assert set(first_order_indices(lambda inputs: 5.0, WIDTHS, 16).values()) == {0.0}


def test_draws_and_bounds_that_serve_no_estimate_are_refused():
    with pytest.raises(ValueError, match="power of 2"):
        first_order_indices(weighted, WIDTHS, 100)
    with pytest.raises(ValueError, match="lowest value below"):
        first_order_indices(weighted, {"one": (1.0, 1.0)}, 16)
