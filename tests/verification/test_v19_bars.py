"""V19: two bars that expand towards each other, with h(p) or h(g) between them.

Reference: `castx/proof/verification/coupled/expanding_bars.py`. The mean pressure and the resultant
are exact on any mesh. Pair by pair the pressure of linear elements alternates with the diagonals
of the cells, since the thermal strain varies inside them: by O(h).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.proof.verification.coupled.expanding_bars import (
    GIVEN,
    GLOWING,
    GLOWING_CLOSED,
    GLOWING_SERIES,
    HOT,
    OPEN,
    ROUGH,
    Bars,
    answers,
    mean,
    steady_case,
)
from tests import coupled_cases

pytestmark = pytest.mark.sampled

SIZES = (0.005, 0.0025)


def case(bars: Bars, model: str, formulation: str, method: str, size: float) -> dict[str, Any]:
    """Return the case: large steps to the steady state, tight tolerances."""
    made = steady_case(bars, model, size)
    for body in made["bodies"]:
        body["formulation"] = formulation
    made["interfaces"][0]["contact"]["method"] = method
    return made


def solve(
    comm, bars: Bars, model="plane-strain", formulation="mixed", method="condensed", size=0.005
) -> dict[str, FloatArray]:
    """Return the answers of a run."""
    found = answers(coupled_cases.states(comm, case(bars, model, formulation, method, size)))
    assert found["cutbacks"][0] == 0
    return found


@pytest.mark.ranks
@pytest.mark.parametrize(
    "bars, options",
    [
        (GIVEN, {}),
        (GIVEN, {"formulation": "displacement"}),
        (GIVEN, {"method": "multipliers"}),
        (GIVEN, {"model": "plane-stress"}),
        (GIVEN, {"model": "3d", "size": 0.01}),
        (HOT, {"size": 0.0025}),
        (GLOWING_CLOSED, {"size": 0.0025}),
        (ROUGH, {}),
    ],
)
def test_closed_bars(comm, bars, options):
    found, exact = solve(comm, bars, **options), bars.exact()
    assert found["gap"] == pytest.approx(0.0, abs=1e-12)
    assert mean(found, "p") == pytest.approx(exact["p"], rel=1e-4)
    assert found["force"][0] == pytest.approx(exact["p"], rel=1e-4)  # towards the casting, +x
    assert mean(found, "h") == pytest.approx(exact["h"], rel=1e-4)
    assert found["q"][0] == pytest.approx(exact["q"], rel=1e-4)
    for face in ("casting", "mould"):
        assert found[face] == pytest.approx(exact[face], rel=1e-4)


@pytest.mark.parametrize(
    "bars, options",
    [
        (OPEN, {}),
        (OPEN, {"formulation": "displacement"}),
        (OPEN, {"method": "multipliers"}),
        (GLOWING, {}),
        (GLOWING_SERIES, {}),
    ],
)
def test_open_bars(comm, bars, options):
    found, exact = solve(comm, bars, **options), bars.exact()
    assert 0 < exact["h"] < OPEN.closed  # the gap rules
    assert found["p"] == pytest.approx(0.0, abs=0.0)
    assert found["gap"] == pytest.approx(exact["gap"], rel=1e-4)
    assert found["h"] == pytest.approx(exact["h"], rel=1e-4)
    assert found["q"][0] == pytest.approx(exact["q"], rel=1e-4)
    for face in ("casting", "mould"):
        assert found[face] == pytest.approx(exact[face], rel=1e-4)


@pytest.mark.parametrize("clearance", [1e-5, 3e-5])
@pytest.mark.parametrize("bars", [OPEN, GLOWING_SERIES])
def test_surfaces_that_soften_conduct_by_what_is_open_beyond_their_clearance(comm, bars, clearance):
    """Heat sees the gap of bars that begin nearer to each other by the clearance."""
    data = case(bars, "plane-strain", "mixed", "exponential", 0.005)
    data["interfaces"][0]["contact"]["clearance"] = clearance
    found = answers(coupled_cases.states(comm, data))
    exact = replace(bars, gap=bars.gap - clearance).exact()
    assert exact["gap"] > clearance
    assert found["p"] == pytest.approx(0.0, abs=0.0)
    assert found["gap"] == pytest.approx(exact["gap"] + clearance, rel=1e-4)
    assert found["h"] == pytest.approx(exact["h"], rel=1e-4)
    assert found["q"][0] == pytest.approx(exact["q"], rel=1e-4)


def test_pressures_of_the_pairs_converge(comm):
    errors = [np.abs(solve(comm, GIVEN, size=h)["p"] / GIVEN.exact()["p"] - 1) for h in SIZES]
    assert errors[0].max() < 1.5e-3
    assert errors[0].max() / errors[1].max() > 1.6
