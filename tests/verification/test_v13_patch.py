"""V13: contact patch test, a stiff block on a soft one.

Two blocks of equal width, 30 and 20 mm high, under a pressure p, without friction, sides free: the
stress is σ_yy = -p in both, so the top of the base moves down by p h (1 - ν²)/E in plane strain and
by p h/E in the other models. R. L. Taylor and P. Papadopoulos (1991), On a patch test for contact
problems in two dimensions.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact
from castx.proof.verification.contact.pressed_blocks import (
    HEIGHT,
    POISSON,
    PRESSURE,
    SETTLING,
    YOUNG,
)
from tests.contact_methods import AT_ONCE, TWO_BODIES
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    motion,
    places,
    pressures,
    problem,
    pushed,
    stresses,
)

pytestmark = pytest.mark.sampled

MODELS = ("plane-strain", "plane-stress", "axisymmetric", "3d")
FORMULATIONS = (("mixed", "osgs"), ("mixed", "gls"), ("displacement", "osgs"))
QUADRATIC = (
    ("taylor-hood", "taylor-hood"), ("taylor-hood", "displacement"), ("mixed", "taylor-hood"),
)  # fmt: skip

SETTINGS = {"block-iterative": {"block_solver": "preconditioner"}}


@pytest.mark.parametrize("method", TWO_BODIES)
@pytest.mark.parametrize(("formulation", "stabilisation"), FORMULATIONS)
@pytest.mark.parametrize("model", MODELS)
def test_pressure_is_uniform_and_displacement_exact(
    comm, model, formulation, stabilisation, method
):
    law = {"formulation": formulation, "stabilisation": stabilisation}
    contact = Contact("upper", "base", method, settings=SETTINGS.get(method, {}))
    check_patch(comm, model, {"upper": law, "base": law}, contact)


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
@pytest.mark.parametrize("model", ["3d", "plane-strain", "axisymmetric", "plane-stress"])
@pytest.mark.parametrize("formulations", QUADRATIC)
def test_quadratic_bodies_pass_it(comm, model, formulations, method):
    """On both sides, and opposite a linear body on either: mid-sides bear their part."""
    laws = {name: {"formulation": of} for name, of in zip(YOUNG, formulations, strict=True)}
    check_patch(comm, model, laws, Contact("upper", "base", method))


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
@pytest.mark.parametrize("model", ["3d", "plane-strain", "axisymmetric"])
@pytest.mark.parametrize("formulations", QUADRATIC)
def test_quadratic_bodies_pass_it_from_node_to_face(comm, model, formulations, method):
    laws = {name: {"formulation": of} for name, of in zip(YOUNG, formulations, strict=True)}
    rule = Pairing(kind="node-to-face", surfaces=("base", "upper"))
    check_patch(comm, model, laws, Contact("upper", "base", method, pairing=rule))


def check_patch(comm, model, laws, contact):
    """Press blocks of two laws together, and compare with the exact answer."""
    bodies = {name: body(elastic(E, POISSON), **laws[name]) for name, E in YOUNG.items()}
    bodies["upper"] = body(
        elastic(YOUNG["upper"], POISSON), **laws["upper"], loads=(pushed("top", PRESSURE),)
    )
    made = problem(blocks(comm, model), bodies, {"base": [fixed("bottom")]}, [contact])
    made.equilibrium.solve(0.0)

    factor = 1 - POISSON**2 if model == "plane-strain" else 1.0
    expected = -PRESSURE * HEIGHT * factor / YOUNG["base"]
    up = 2 if model == "3d" else 1
    top = np.abs(places(made, "base")[:, up]) < 1e-9
    moved = everywhere(comm, motion(made, "base")[top, up])
    np.testing.assert_allclose(moved, expected, rtol=1e-8)
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=1e-8)
    reported = everywhere(comm, made.contact_states()[0].pressure)
    np.testing.assert_allclose(reported, PRESSURE, rtol=1e-8)
    for name in YOUNG:
        stress = stresses(comm, made, name)
        np.testing.assert_allclose(stress[:, up], -PRESSURE, rtol=1e-8)
        np.testing.assert_allclose(stress[:, 3:], 0.0, atol=1e-8 * PRESSURE)
    if model == "plane-strain":
        assert expected == pytest.approx(SETTLING, rel=1e-12)
    assert made.equilibrium.support_force() < 1e-8 * PRESSURE * HEIGHT


def test_bodies_in_turn_pass_it_too(comm):
    """A soft penalty, since the upper block stands on its springs alone and the sweeps are slow."""
    bodies = {
        "upper": body(elastic(YOUNG["upper"], POISSON), loads=(pushed("top", PRESSURE),)),
        "base": body(elastic(YOUNG["base"], POISSON)),
    }
    contact = Contact(
        "upper", "base", "block-iterative",
        settings={"penalty": 1e11, "block_iterations": 2000},
    )  # fmt: skip
    made = problem(blocks(comm, size=0.01), bodies, {"base": [fixed("bottom")]}, [contact])
    assert made.equilibrium.solve(0.0).balanced
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=1e-8)
    top = np.abs(places(made, "base")[:, 1]) < 1e-9
    np.testing.assert_allclose(everywhere(comm, motion(made, "base")[top, 1]), SETTLING, rtol=1e-8)
