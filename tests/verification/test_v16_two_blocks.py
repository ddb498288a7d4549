"""V16: two blocks pressed together (Chiumenti, section 10.1).

E 1000 MPa on 10000 MPa, plane strain, ν 0.3, the top displaced by a given amount, so that the
reaction is an answer. There is no closed form for a base that is wider: the methods are compared on
one mesh, and for equal widths and free sides with the series of two layers,
F = d b / ((1 - ν²) (H1/E1 + H2/E2)).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.proof.verification.contact import wide_base
from castx.proof.verification.contact.wide_base import POISSON, PUSH, YOUNG
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, pressures, problem

pytestmark = pytest.mark.sampled


def reaction(
    comm, method: str, base_width: float, formulation: str = "mixed", **settings
) -> tuple[float, int]:
    """Return the sum of the contact forces [N/m] and the number of closed pairs."""
    mesh = blocks(comm, base=(base_width, 0.02), size=0.0025)
    bodies = {n: body(elastic(E, POISSON), formulation=formulation) for n, E in YOUNG.items()}
    made = problem(
        mesh,
        bodies,
        {"base": [fixed("bottom")], "upper": [fixed("top", value=-PUSH)]},
        [Contact("upper", "base", method, settings=settings)],
    )
    made.equilibrium.solve(0.0)
    assert pressures(comm, made).min() >= 0.0
    forces = everywhere(comm, made.pair_values()[1])
    return float(forces.sum()), int(np.count_nonzero(forces))


@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
@pytest.mark.parametrize("base_width", [0.02, 0.04])
def test_methods_agree(comm, base_width, formulation):
    multipliers = reaction(comm, "multipliers", base_width, formulation)
    condensed = reaction(comm, "condensed", base_width, formulation)
    assert multipliers[1] == condensed[1] > 0
    assert condensed[0] == pytest.approx(multipliers[0], rel=1e-10)


def test_equal_widths_are_springs_in_series(comm):
    found = reaction(comm, "condensed", 0.02)[0]
    assert found == pytest.approx(wide_base.reaction(), rel=1e-9)


@pytest.mark.parametrize("base_width", [0.02, 0.04])
def test_penalty_tends_to_the_exact_reaction_from_below(comm, base_width):
    exact = reaction(comm, "condensed", base_width)[0]
    errors = [
        1 - reaction(comm, "penalty", base_width, penalty=penalty)[0] / exact
        for penalty in (1e12, 1e13, 1e14)
    ]
    assert 0.02 < errors[0] < 0.05
    for coarse, fine in pairwise(errors):
        assert 0 < fine < 0.13 * coarse


@pytest.mark.ranks
@pytest.mark.parametrize("penalty", ["auto", 1e12])
def test_augmented_lagrangian_reaches_the_exact_reaction(comm, penalty):
    exact = reaction(comm, "condensed", 0.04)[0]
    found = reaction(comm, "augmented-lagrangian", 0.04, penalty=penalty)[0]
    assert found == pytest.approx(exact, rel=1e-10)


def test_automatic_penalty_is_stiff_beside_the_softer_block(comm):
    exact = reaction(comm, "condensed", 0.04)[0]
    error = 1 - reaction(comm, "penalty", 0.04)[0] / exact
    assert 1e-5 < error < 2e-2
