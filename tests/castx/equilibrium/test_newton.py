"""Newton's method on two bars whose answer is known, and what it reports."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.errors import ConvergenceError
from tests.contact_methods import IN_THE_LIMIT
from tests.elastic_bodies import blocks, body, elastic, fixed, gaps, pressures, problem

LENGTH, SQUEEZE, YOUNG = 0.02, 2e-5, {"upper": 7e9, "base": 70e9}


def bars(comm, method="condensed", **settings):
    """Return two bars without lateral strain, of one cell in width, squeezed by 20 µm."""
    mesh = blocks(comm, upper=(0.02, LENGTH), base=(0.02, LENGTH), size=LENGTH)
    bodies = {name: body(elastic(E, 0.0)) for name, E in YOUNG.items()}
    held = {"base": [fixed("bottom")], "upper": [fixed("top", value=-SQUEEZE)]}
    contact = Contact("upper", "base", method, lambda x: np.full(len(x), 5e-6))
    return problem(mesh, bodies, held, [contact], **settings)


@pytest.mark.serial
@pytest.mark.parametrize("method", IN_THE_LIMIT)
def test_two_bars(comm, method):
    """An open pair closes, p = (d - g0)/(L/E1 + L/E2); one linear problem for each set."""
    made = bars(comm, method)
    report = made.equilibrium.solve(0.0)
    exact = (SQUEEZE - 5e-6) / sum(LENGTH / E for E in YOUNG.values())
    np.testing.assert_allclose(pressures(comm, made), exact, rtol=1e-9)
    np.testing.assert_allclose(gaps(comm, made), 0.0, atol=1e-12)
    assert report.contact_changes == 2 and report.balanced
    assert report.iterations == 2 + len(report.augmentations)
    assert len(report.residuals) == report.iterations + 1 + len(report.augmentations)
    assert report.linear_iterations == sum(report.linear_solves)


@pytest.mark.serial
def test_a_failure_says_where_the_residual_is_largest(comm):
    made = bars(comm, options={"snes_max_it": 1})
    with pytest.raises(ConvergenceError, match=r"did not converge.*body '(upper|base)'"):
        made.equilibrium.solve(0.0)
