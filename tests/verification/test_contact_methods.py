"""Section 10.1 and Table 1 of Chiumenti: how the methods converge and what a penalty costs.

A soft block on a base that is ten times stiffer, both of one width and free at their sides, so that
they are springs in series: per area k_i = E_i/((1 - ν²) H_i), 1/k = 1/k_1 + 1/k_2. The reaction to
a penalty ε falls short by k/(k + ε). Solved in turn, the soft block sees the base through the
penalty and the other way round, and a sweep over both leaves ε²/((ε + k_1)(ε + k_2)) of the error.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.methods.registry import METHODS
from castx.equilibrium.newton import EquilibriumReport
from castx.equilibrium.problem import MechanicalProblem
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from tests.contact_methods import AT_ONCE, sharp
from tests.elastic_bodies import STRESS_FREE, blocks, elastic, everywhere, fixed, problem

pytestmark = pytest.mark.sampled

SOFT, POISSON, PUSH = 1e9, 0.3, 2e-4
HEIGHTS = {"upper": 0.03, "base": 0.02}
YOUNG = {"upper": SOFT, "base": 10 * SOFT}
STIFFNESS = {n: E / ((1 - POISSON**2) * HEIGHTS[n]) for n, E in YOUNG.items()}


def pressed(
    comm, push: float = PUSH, model: str = "plane-strain", law: str = "thermo-elastic",
    size: float = 0.005, tolerance: float = 1e-9, linear: str = "direct",
    method: str = "condensed", **settings
) -> tuple[MechanicalProblem, EquilibriumReport]:  # fmt: skip
    """Return the solved problem and how it was solved."""
    mesh = blocks(comm, model, size=size)
    bodies = {
        n: MechanicalBody(
            Law(elastic(E, POISSON, yield_stress=7e6, hardening=5e7), STRESS_FREE, law)
        )
        for n, E in YOUNG.items()
    }
    made = problem(
        mesh, bodies, {"base": [fixed("bottom")], "upper": [fixed("top", value=-push)]},
        [Contact("upper", "base", method, settings=settings)], tolerance=tolerance, linear=linear,
    )  # fmt: skip
    return made, made.equilibrium.solve(1.0)


def reaction(comm, made: MechanicalProblem) -> float:
    """Return the sum of the contact forces [N/m]."""
    return float(everywhere(comm, made.pair_values()[1]).sum())


@pytest.mark.parametrize("penalty", [1e11, 1e13])
def test_a_penalty_is_a_spring_in_series(comm, penalty):
    exact = reaction(comm, pressed(comm, method="condensed")[0])
    found = reaction(comm, pressed(comm, method="penalty", penalty=penalty)[0])
    both = 1 / sum(1 / k for k in STIFFNESS.values())
    assert 1 - found / exact == pytest.approx(both / (both + penalty), rel=1e-5)


@pytest.mark.ranks
@pytest.mark.parametrize("penalty", [1e11, 1e12, 1e13])
def test_a_sweep_over_the_bodies_leaves_what_the_penalty_does_not_hand_over(comm, penalty):
    _, report = pressed(
        comm, method="block-iterative", penalty=penalty, block_iterations=8, tolerance=1e-12
    )
    ends = [report.residuals[start - 1] for start in (*report.sweeps[1:], 0)]
    expected = np.prod([penalty / (penalty + k) for k in STIFFNESS.values()])
    assert len(ends) == 8 and not report.balanced
    for before, after in pairwise(ends[:5]):
        assert after / before == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("method", sharp(AT_ONCE))
def test_newton_ends_quadratically(comm, method):
    given = {"penalty": 1e12} if METHODS[method].uses("penalty") else {}
    _, report = pressed(
        comm, push=1e-3, law="thermo-elasto-plastic", tolerance=1e-6, method=method, **given
    )
    first = report.residuals[: (*report.augmentations, len(report.residuals))[0]]
    assert 4 <= len(first) <= 6
    falls = [np.log(after / before) for before, after in pairwise(first)]
    assert falls[-1] / falls[-2] > 1.7


def test_the_iterative_solver_feels_a_penalty_but_not_the_condensed_contact(comm):
    """A hard penalty makes stiff nodes, for which the preconditioner has factors."""
    def worst(size: float = 0.005, **contact) -> int:
        _, report = pressed(
            comm, model="3d", size=size, tolerance=1e-3, linear="iterative", **contact
        )
        return max(report.linear_solves)

    rising = [worst(method="penalty", penalty=e) for e in (1e12, 1e13, 1e14, 1e15)]
    assert rising[0] < rising[1] and max(rising) < 2 * rising[0]
    coarse, fine = (worst(method="condensed", size=size) for size in (0.005, 0.0025))
    assert max(coarse, fine) <= rising[0] + 2
    assert fine <= coarse + 4
