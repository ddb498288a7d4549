"""V7: manufactured solutions of the mixed u/p elements, and the hydrostatic container.

A displacement that vanishes on all faces of the unit square or cube but the upper one, which is
free of traction, and an independent pressure:
    u = sin(πx) y (1 - y)² (1, -2),  p = (1 - y) cos(πx)   (in the cube with sin(πx) sin(πy) and z),
with G = 1 for every ν. The body force is b = -∇·s - ∇p, the volumetric thermal strain
e^θ = ∇·u - p/K. P. J. Roache (2002), Code verification by the method of manufactured solutions.
Linear u/p elements: u converges with order 2 in L2 and 1 in H1, p with order 1 or better.

The container: rigid, frictionless, open on top, with 1/K = 0 under gravity ρg: u = 0 and p = -ρg
times the depth, however stiff its parts.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.proof.verification.solids.manufactured import (
    LARGEST_ERRORS,
    WEIGHT,
    container,
    manufactured,
    nodal_answers,
    relative_errors,
)

SIZES = {2: (32, 64), 3: (12, 16)}
RATES = (2.0, 1.0, 1.5)
"""Of u in L2, of u in H1, of p in L2."""


@pytest.mark.sampled
@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
@pytest.mark.parametrize("poisson", [0.3, 0.4999, 0.5])
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_convergence(comm, dimension, stabilisation, poisson):
    sizes = np.array(SIZES[dimension])
    errors = [
        relative_errors(manufactured(comm, dimension, 1.0 / n, poisson, stabilisation))
        for n in sizes
    ]
    rates = np.log(errors[0] / errors[1]) / np.log(sizes[1] / sizes[0])
    assert np.all(rates > np.array(RATES) - 0.1), rates
    assert np.all(errors[-1] < LARGEST_ERRORS[dimension]), errors[-1]


@pytest.mark.ranks
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_hydrostatic_container(comm, dimension, stabilisation):
    """Stiff at one side, 1e3 times softer at the other, in between over one element."""
    made = container(comm, dimension, 1 / {2: 16, 3: 6}[dimension], stabilisation)
    places, moved, pressures = nodal_answers(made)
    np.testing.assert_allclose(pressures, -WEIGHT * (1 - places[:, -1]), atol=1e-6 * WEIGHT)
    assert np.abs(moved).max() < 1e-6 * WEIGHT / 10e6
