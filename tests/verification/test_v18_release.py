"""V18: an elastic cube cut by an inclined plane closes when heated and opens when cooled.

The x faces are held in x, the y faces in y, the z faces free. Heated by ΔT above the stress-free
temperature each part is in the state σ_xx = σ_yy = -E α ΔT/(1 - ν), σ_zz = 0 (Timoshenko and
Goodier, Theory of Elasticity, 3rd ed., section 149: a plate that cannot expand in its plane). It is
hydrostatic in the x-y plane, so that every plane with its normal there carries this pressure and no
shear.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.proof.verification.contact.cut_cube import (
    EXPANSION,
    POISSON,
    SIDE,
    YOUNG,
    contact_pressure,
    draw_cut_cube,
)
from tests.contact_methods import IN_THE_LIMIT
from tests.elastic_bodies import (
    STRESS_FREE,
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    gaps,
    heat,
    motion,
    places,
    pressures,
    problem,
    stresses,
)

pytestmark = pytest.mark.sampled


def cut_cube(comm, folder, law: dict, method: str):
    mesh = drawn(comm, "3d", ["left", "right"], folder / "cube.msh", draw_cut_cube)
    part = body(elastic(YOUNG, POISSON, EXPANSION), **law)
    held = {
        "left": [fixed("x-low", "x"), fixed("y-low", "y"), fixed("y-high", "y")],
        "right": [fixed("x-high", "x"), fixed("y-low", "y"), fixed("y-high", "y")],
    }
    contact = Contact("left", "right", method)
    return problem(mesh, {"left": part, "right": part}, held, [contact])


@pytest.mark.parametrize("method", IN_THE_LIMIT)
@pytest.mark.parametrize(
    "law",
    [{}, {"stabilisation": "gls"}, {"formulation": "displacement"}, {"formulation": "taylor-hood"}],
)
def test_uniform_pressure_then_release(comm, shared_tmp_path, law, method):
    made = cut_cube(comm, shared_tmp_path, law, method)
    for excess in (10.0, 4.0):
        heat(made, STRESS_FREE + excess)
        made.equilibrium.solve(0.0)
        expected = contact_pressure(excess)
        np.testing.assert_allclose(pressures(comm, made), expected, rtol=1e-8)
        assert np.abs(gaps(comm, made)).max() < 1e-12
        for name in made.bodies:
            stress = stresses(comm, made, name)
            np.testing.assert_allclose(stress[:, :2], -expected, rtol=1e-8)
            np.testing.assert_allclose(stress[:, 2:], 0.0, atol=1e-8 * expected)
            height = everywhere(comm, places(made, name))[:, 2]
            strain = (1 + POISSON) / (1 - POISSON) * EXPANSION * excess
            np.testing.assert_allclose(
                everywhere(comm, motion(made, name))[:, 2],
                strain * (height - SIDE / 2),
                atol=1e-7 * strain * SIDE,
            )
        made.equilibrium.commit()

    for excess in (-0.5, -1.0, -30.0):
        heat(made, STRESS_FREE + excess)
        report = made.equilibrium.solve(0.0)
        assert np.all(pressures(comm, made) == 0.0)
        assert gaps(comm, made).min() > 0.0
        assert (report.contact_changes > 0) == (excess == -0.5)
        made.equilibrium.commit()
    assert made.equilibrium.support_force() < 1e-8 * 2.288e7 * SIDE**2
