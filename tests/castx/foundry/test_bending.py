"""Errors of walls between the counts of cells for which they were measured, and their words."""

from dataclasses import replace

import numpy as np
import pytest

from castx.foundry.bending import BENDING, FREEZING, ThinWalls, bending_error, freezing_error

pytestmark = pytest.mark.serial


def test_between_the_counts_errors_go_by_the_logarithm():
    assert bending_error("mixed", "triangle", np.sqrt(8.0)) == pytest.approx(-0.205)
    assert bending_error("mixed", "triangle", 0.3) == BENDING["mixed", "triangle"][0]
    assert bending_error("mixed", "triangle", 99.0) == BENDING["mixed", "triangle"][-1]
    assert bending_error("unknown", "triangle", 2.0) is None


def test_what_freezing_leaves_goes_by_the_logarithm_too():
    stress, distortion = FREEZING["taylor-hood"]
    assert freezing_error("taylor-hood", 1.0) == (stress[0], distortion[0])
    assert freezing_error("taylor-hood", np.sqrt(2.0)) == pytest.approx((0.5, 0.35))
    assert freezing_error("taylor-hood", 9.0) == (stress[-1], distortion[-1])
    assert freezing_error("q1p0", 1.0) is None


def test_cells_that_bend_well_are_told_what_freezing_leaves():
    walls = ThinWalls(
        body="box", cells="triangles", formulation="taylor-hood", one=0.9, two=0.9, few=0.9,
        thinnest=3e-3, thickest=3e-3, across=1.0, error=None, error_if_fine=None,
        freezing_error=(0.6, 0.5), freezing_error_if_fine=(0.2, 0.05),
    )  # fmt: skip
    assert walls.text == walls.freezing_text
    for part in (
        "box has walls of 3 mm with few cells across (of its surface 90 % with 1): residual ",
        "stress is about 60 % of its root mean square off from place to place, and the ",
        "distortion by it up to 50 %; cells of 0.75 mm there, 4 across, leave 20 % and 5 %",
    ):
        assert part in walls.text
    thick = replace(walls, thinnest=99.6e-3, thickest=0.15, across=0.2)
    assert "walls of 100 to 150 mm" in thick.text
