"""Errors of bending between the counts of cells for which they were measured."""

import numpy as np
import pytest

from castx.foundry.bending import BENDING, bending_error

pytestmark = pytest.mark.serial


def test_between_the_counts_errors_go_by_the_logarithm():
    assert bending_error("mixed", "triangle", np.sqrt(8.0)) == pytest.approx(-0.205)
    assert bending_error("mixed", "triangle", 0.3) == BENDING["mixed", "triangle"][0]
    assert bending_error("mixed", "triangle", 99.0) == BENDING["mixed", "triangle"][-1]
    assert bending_error("unknown", "triangle", 2.0) is None
