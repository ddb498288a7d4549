"""Rigid bodies: contact with them against closed forms and against bodies that hardly give way."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.kinematics.rigid import rigid_body
from castx.errors import CaseError
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table
from tests.contact_methods import WITH_RIGID_BODIES, sharp
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    gaps,
    generated,
    heat,
    motion,
    pressures,
    problem,
)

CASTING, HARD = (7e9, 0.33, 2e-5), 7e15
HEIGHT, POISSON = 0.03, 0.33


def ring(comm, method, young=None, **settings):
    """Return a hot ring on a core, of which a part has come off."""
    mesh = generated(
        comm, "plane-strain", "core_in_ring", ["core", "casting"],
        core_radius=0.03, outer_radius=0.05, size=0.004,
    )  # fmt: skip
    bodies = {"casting": body(elastic(*CASTING))}
    if young is not None:
        bodies = {"core": body(elastic(young, 0.3)), **bodies}
    contact = Contact("casting", "core", method, lambda x: -1e-5 + 4e-3 * x[:, 0])
    made = problem(mesh, bodies, {}, [contact], **settings)
    heat(made, lambda x: 20 - 2e3 * x[:, 0])
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.parametrize("method", ["rigid", "multipliers"])
def test_a_rigid_core_is_the_limit_of_a_hard_one(comm, method):
    expected = pressures(comm, ring(comm, "condensed", HARD))
    found = pressures(comm, ring(comm, method))
    assert 0 < np.count_nonzero(expected) < len(expected)
    np.testing.assert_allclose(found, expected, atol=1e-5 * expected.max())


@pytest.mark.parametrize("linear", ["direct", "iterative"])
@pytest.mark.parametrize("method", sharp(WITH_RIGID_BODIES))
def test_a_led_punch_squeezes_a_block(comm, method, linear):
    """The base comes up by d(t) against a block whose top is held: p = d E/((1 - ν²) h)."""
    upper = {"upper": body(elastic(*CASTING))}
    table = Table.from_points([(0.0, 0.0), (2.0, 1e-4)])
    led = {"upper": [fixed("top")], "base": [SurfaceDisplacement("bottom", "y", table)]}
    contact = Contact(
        "upper", "base", method, settings={"penalty": 1e14} if method == "penalty" else {}
    )
    made = problem(blocks(comm), upper, led, [contact], linear=linear, tolerance=1e-10)
    for time, moved in ((1.0, 5e-5), (2.0, 1e-4)):
        made.equilibrium.solve(time)
        compliance = (1 - POISSON**2) * HEIGHT / CASTING[0] + (method == "penalty") / 1e14
        np.testing.assert_allclose(pressures(comm, made), moved / compliance, rtol=1e-7)
        np.testing.assert_allclose(made.rigid["base"].displacement(time), [0.0, moved])
        made.equilibrium.commit()
    made.equilibrium.solve(0.0)
    made.equilibrium.rewind()
    np.testing.assert_allclose(pressures(comm, made), 1e-4 / compliance, rtol=1e-7)


def test_a_punch_that_goes_away_opens_the_gap(comm):
    led = {"upper": [fixed("top")], "base": [fixed("bottom", "y", -1e-4)]}
    made = problem(
        blocks(comm), {"upper": body(elastic(*CASTING))}, led, [Contact("upper", "base", "rigid")]
    )
    made.equilibrium.solve(0.0)
    np.testing.assert_allclose(gaps(comm, made), 1e-4, rtol=1e-12)
    assert np.abs(everywhere(comm, motion(made, "upper"))[:, :2]).max() < 1e-15


@pytest.mark.parametrize(
    ("secondary", "primary", "method", "deformable", "text"),
    [
        ("upper", "base", "rigid", ["upper", "base"], "needs a rigid primary body; give 'base'"),
        ("upper", "base", "condensed", ["base"], r"'upper' is rigid; .* \[\"base\", \"upper\"\]"),
        ("upper", "base", "condensed", [], "both bodies are rigid; use method"),
    ],
)
def test_refused_bodies(comm, secondary, primary, method, deformable, text):
    bodies = {name: body(elastic(*CASTING)) for name in deformable}
    with pytest.raises(CaseError, match=f"interface upper/base: .*{text}"):
        problem(blocks(comm), bodies, {}, [Contact(secondary, primary, method)])


@pytest.mark.parametrize(
    ("conditions", "text"),
    [
        ([fixed("bottom", "normal", 1e-3)], "give it along the axes x, y"),
        ([fixed("bottom", "y", 1e-3), fixed("side", "y", 2e-3)], "'y' on base/side contradicts"),
        ([SurfaceDisplacement("bottom", "y", None)], "is uniform, but the body is rigid"),
    ],
)
def test_refused_paths(conditions, text):
    with pytest.raises(CaseError, match=text):
        rigid_body("base", "plane-strain", conditions)


def test_supports_of_a_rigid_body_are_accepted():
    at_rest = [fixed("bottom"), fixed("side", "all"), fixed("bottom", "x", 2e-3)]
    np.testing.assert_array_equal(
        rigid_body("base", "plane-strain", at_rest).displacement(0.0), [2e-3, 0.0]
    )
    with pytest.raises(CaseError, match="cannot move along r"):
        rigid_body("base", "axisymmetric", [fixed("side", "r", 1e-3)])
