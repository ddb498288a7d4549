"""The Jacobian of trapped liquid at an interface, in the unknowns of the contact methods."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from tests.castx.mechanics.lone_bodies import MELTING
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import STRESS_FREE, blocks, body, elastic, fixed, heat, problem
from tests.small_contact import SOFT, STIFF, waves

pytestmark = pytest.mark.sampled


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
@pytest.mark.parametrize("molten", ["all", "foot"])
def test_jacobian_where_a_full_pocket_lies_at_the_interface(comm, method, molten):
    """Its one pressure ties all nodes round it, in the unknowns of the contact method.

    Pores would open far from there only.
    """
    mesh = blocks(comm, symmetry=False, size=0.01)
    bodies = {
        "upper": body(elastic(*SOFT, **MELTING, cavitation=1e9), starts_liquid=True),
        "base": body(elastic(*STIFF)),
    }
    held = {"base": [fixed("bottom", "all")], "upper": [fixed("top"), fixed("side", "x")]}
    made = problem(mesh, bodies, held, [Contact("upper", "base", method)])

    def fraction(points):
        return np.where((points[:, 1] < 0.012) | (molten == "all"), 0.0, 1.0)

    heat(made, STRESS_FREE, fraction)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    assert balance.assembly.has_pockets
    liquid = ~made.bodies["upper"].coherent
    assert comm.allreduce(bool(liquid.all()), op=min) == (molten == "all")
    balance.begin(x, 0.0)
    direction, results = x.duplicate(), []
    direction.array[:] = 1e-8 * waves(x)
    for sign in (1.0, -1.0):
        moved, f = x.copy(), x.duplicate()
        moved.axpy(sign, direction)
        balance.residual(moved, f)
        results.append(f.array_r.copy())
    product = x.duplicate()
    balance.operator.mult(None, direction, product)
    difference = (results[0] - results[1]) / 2
    scale = comm.allreduce(np.abs(difference).max(initial=0.0), op=max)
    np.testing.assert_allclose(difference, product.array_r, atol=1e-6 * scale)
