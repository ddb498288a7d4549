"""Friction of node pairs: stick and slip in closed form, derivatives, shrink fits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.friction.coulomb import forward, shortened, unit
from castx.errors import CaseError
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table
from tests.contact_methods import WITH_FRICTION
from tests.coupled_cases import final_state, merged, ring
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    normal_forces,
    places,
    problem,
    pushed,
)

pytestmark = pytest.mark.sampled

SOFT, STIFF = (7e9, 0.33), (70e9, 0.3)
WEIGHT = 1e5
AREA = 0.02 * 0.03


def on_an_incline(comm, method, slope, friction, rigid=False, model="plane-strain"):
    """Return a block on a wider base, under a body force inclined to the base's normal."""
    sideways, down = WEIGHT * math.sin(slope), -WEIGHT * math.cos(slope)
    force = (sideways, 0.0, down) if model == "3d" else (sideways, down)
    bodies = {"upper": body(elastic(*SOFT), body_force=force)}
    if not rigid:
        bodies["base"] = body(elastic(*STIFF), formulation="displacement")
    mesh = blocks(comm, model, base=(0.04, 0.02), symmetry=False, size=0.01)
    contact = Contact("upper", "base", method, friction=friction)
    made = problem(mesh, bodies, {"base": [fixed("bottom", "all")]}, [contact])
    made.equilibrium.solve(0.0)
    return made


def force(comm, made):
    """Return the contact force on the upper block."""
    return everywhere(comm, made.contact_states()[0].force).sum(axis=0)


def sliding_forces(made):
    """Return the magnitude of the friction of the pairs on this rank [N]."""
    normal = normal_forces(made)[:, None] * made.pairs[0].normals
    return np.linalg.norm(made.contact_states()[0].force - normal, axis=1)


@pytest.mark.ranks
@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
@pytest.mark.parametrize("method", WITH_FRICTION)
def test_a_block_sticks_on_a_gentle_slope(comm, method, model, rigid):
    slope = math.radians(20)
    made = on_an_incline(comm, method, slope, 0.5 if model == "3d" else 0.4, rigid, model)
    total = WEIGHT * AREA * (0.01 if model == "3d" else 1.0)
    up = 2 if model == "3d" else 1
    found = force(comm, made)
    assert found[0] == pytest.approx(-total * math.sin(slope), rel=1e-8)
    assert found[up] == pytest.approx(total * math.cos(slope), rel=1e-8)
    assert made.equilibrium.support_force() < 1e-8 * total
    assert np.abs(everywhere(comm, motion(made, "upper"))[:, 0]).max() < 1e-5


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("method", WITH_FRICTION)
def test_a_block_slides_on_a_steep_slope_until_its_spring_holds_it(comm, method, rigid):
    """The support bears what friction does not: W (sin θ - μ cos θ)."""
    slope, friction = math.radians(30), 0.25
    made = on_an_incline(comm, method, slope, friction, rigid)
    total = WEIGHT * AREA
    found = force(comm, made)
    assert found[0] == pytest.approx(-friction * total * math.cos(slope), rel=1e-6)
    rest = total * (math.sin(slope) - friction * math.cos(slope))
    support = made.equilibrium.supports()["upper"].force
    assert support[0] == pytest.approx(-rest, rel=1e-6)
    # Every pair bears μ times its own normal force.
    normal, along = normal_forces(made), sliding_forces(made)
    np.testing.assert_allclose(along, friction * normal, rtol=1e-6, atol=1e-9 * total)


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
@pytest.mark.parametrize("method", WITH_FRICTION)
def test_a_block_dragged_over_its_base_bears_its_friction(comm, method, model, rigid):
    """Every pair bears μ times its normal force against the motion."""
    friction = 0.25
    bodies = {"upper": body(elastic(*SOFT), loads=(pushed("top", 1e6),))}
    if not rigid:
        bodies["base"] = body(elastic(*STIFF), formulation="displacement")
    mesh = blocks(comm, model, base=(0.04, 0.02), symmetry=False, size=0.01)
    held = {"base": [fixed("bottom", "all")], "upper": [fixed("top", "x", 2e-5)]}
    contact = Contact("upper", "base", method, friction=friction)
    made = problem(mesh, bodies, held, [contact])
    made.equilibrium.solve(0.0)
    assert made.equilibrium.active.frozen_pairs() == 0
    gaps, _ = made.pair_values()
    assert np.all(gaps[~made.equilibrium.active.closed] > 0.0)
    found = force(comm, made)
    normal = 1e6 * 0.02 * (0.01 if model == "3d" else 1.0)
    assert found[-1] == pytest.approx(normal, rel=1e-8)
    assert found[0] == pytest.approx(-friction * normal, rel=1e-3 if model == "3d" else 1e-8)
    along = sliding_forces(made)
    np.testing.assert_allclose(along, friction * normal_forces(made), atol=1e-8 * normal)
    moved = everywhere(comm, motion(made, "upper"))[:, 0]
    assert moved.min() > 5e-6
    if not rigid:
        base = made.bodies["base"]
        rows = base.residual().reshape(-1, base.block_size)
        above = places(made, "base")[:, -1] > -0.02 + 1e-9
        reaction = comm.allreduce(rows[above].sum(axis=0))
        np.testing.assert_allclose(reaction + found, 0.0, atol=1e-10 * normal)


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
@pytest.mark.parametrize("method", WITH_FRICTION)
def test_jacobian_against_differences_of_the_residual(comm, method, model):
    """Pairs that stick, slip and are open, in the plane and turning in space."""
    mesh = blocks(comm, model, base=(0.04, 0.02), symmetry=False, size=0.01)
    loads = (pushed("top", 1e6),)
    drag = {"x": 5e-6, "y": 2e-6} if model == "3d" else {"x": 5e-6}
    bodies = {"upper": body(elastic(*SOFT), loads=loads, stabilisation="gls"),
              "base": body(elastic(*STIFF), stabilisation="gls")}  # fmt: skip
    held = {"base": [fixed("bottom", "all")],
            "upper": [fixed("top", axis, value) for axis, value in drag.items()]}  # fmt: skip
    contact = Contact("upper", "base", method, friction=0.3)
    made = problem(mesh, bodies, held, [contact])
    made.equilibrium.solve(0.0)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    _, sticks = np.split(balance.contact.state(balance.active.closed), 2)
    assert {True, False} <= set(everywhere(comm, sticks))
    start, f = x.duplicate(), x.duplicate()
    x.copy(start)
    first = x.getOwnershipRange()[0]
    # Away from the solution, where all parts of the derivative count.
    start.array[:] += 1e-9 * np.cos(1.0 + 1.3 * (first + np.arange(start.getLocalSize())))
    direction = start.duplicate()
    direction.array[:] = np.sin(1.0 + 0.7 * (first + np.arange(start.getLocalSize())))
    step, results = 1e-12, []
    for sign in (1.0, -1.0):
        trial = start.copy()
        trial.axpy(sign * step, direction)
        balance.residual(trial, f)
        results.append(f.array_r.copy())
    balance.residual(start, f)
    balance.update_matrix()
    product = f.duplicate()
    balance.operator.mult(None, direction, product)
    difference = (results[0] - results[1]) / (2 * step)
    scale = comm.allreduce(np.abs(difference).max(initial=0.0), op=max)
    np.testing.assert_allclose(difference, product.array_r, atol=1e-5 * scale)


def shaft(comm, method, friction, push, linear="direct"):
    """Return a hub shrunk on a shaft that is pushed out of it, after steps of the given pushes."""
    mesh = generated(
        comm, "axisymmetric", "core_in_ring", ["core", "casting"],
        core_radius=0.03, outer_radius=0.06, height=0.04, size=0.01,
    )  # fmt: skip
    bodies = {"core": body(elastic(*STIFF)), "casting": body(elastic(*SOFT))}
    table = Table.from_points([(float(k), value) for k, value in enumerate((0.0, *push))])
    held = {"casting": [fixed("outside", "z")], "core": [SurfaceDisplacement("base", "z", table)]}
    contact = Contact(
        "casting", "core", method, lambda x: np.full(len(x), -2e-5), friction=friction
    )
    made = problem(mesh, bodies, held, [contact], linear=linear, tolerance=1e-10)
    found = []
    for time in range(1, len(push) + 1):
        made.equilibrium.solve(float(time))
        found.append((force(comm, made)[1], everywhere(comm, normal_forces(made)).sum()))
        made.equilibrium.commit()
    return np.array(found)


@pytest.mark.parametrize("linear", ["direct", "iterative"])
@pytest.mark.parametrize("method", WITH_FRICTION)
def test_a_shrink_fit_is_pushed_out_by_its_friction(comm, method, linear):
    """Once all pairs slip the axial force is μ times the normal one; before it grows with the push.

    Pushed back, the fit sticks again and then slips the other way.
    """
    friction = 0.15
    found = shaft(comm, method, friction, (1e-7, 4e-5, 8e-5, 7.9e-5, 0.0), linear)
    axial, normal = found.T
    assert 0 < axial[0] < 0.9 * friction * normal[0]
    np.testing.assert_allclose(axial[1:3], friction * normal[1:3], rtol=1e-6)
    # Lamé: p (C1 + C2) = δ; friction changes the pressure a little by Poisson's ratio.
    (E, nu), (E_hub, nu_hub), a, b = STIFF, SOFT, 0.03, 0.06
    compliance = a * (1 - nu) / E + a / E_hub * ((b**2 + a**2) / (b**2 - a**2) + nu_hub)
    exact = friction * 2e-5 / compliance * 2 * math.pi * a * 0.04
    np.testing.assert_allclose(axial[1:3], exact, rtol=0.03)
    assert axial[3] < 0.99 * axial[2]
    assert axial[4] == pytest.approx(-friction * normal[4], rel=1e-6)


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_without_friction_it_slides_freely(comm, method):
    axial, normal = shaft(comm, method, 0.0, (4e-5,)).T
    assert np.abs(axial) < 1e-9 * normal


@pytest.mark.ranks
def test_methods_agree_as_the_penalty_grows(comm):
    """Friction by a penalty tends to that of the condensed method, sticking included."""
    exact = shaft(comm, "condensed", 0.15, (2e-6,))
    assert shaft(comm, "penalty", 0.15, (2e-6,)) == pytest.approx(exact, rel=0.05)


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_a_rewind_forgets_what_has_slipped(comm, method):
    made = on_an_incline(comm, method, math.radians(20), 0.4)
    made.equilibrium.commit()
    before = force(comm, made)
    heat(made, 520.0)
    made.equilibrium.solve(1.0)
    made.equilibrium.rewind()
    heat(made, 20.0)
    made.equilibrium.solve(1.0)
    np.testing.assert_allclose(force(comm, made), before, atol=1e-8 * np.abs(before).max())


@pytest.mark.ranks
def test_a_led_punch_drags_a_block_along(comm):
    """The rigid base moves sideways: a block that sticks follows it."""
    mesh = blocks(comm, base=(0.04, 0.02), symmetry=False, size=0.01)
    table = Table.from_points([(0.0, 0.0), (1.0, 1e-3)])
    led = {"base": [SurfaceDisplacement("bottom", "x", table)]}
    upper = {"upper": body(elastic(*SOFT), loads=(pushed("top", 1e6),))}
    for method in WITH_FRICTION:
        contact = Contact("upper", "base", method, friction=0.3)
        made = problem(mesh, upper, led, [contact], tolerance=1e-10)
        made.equilibrium.solve(0.0)
        made.equilibrium.commit()
        made.equilibrium.solve(1.0)
        moved = everywhere(comm, motion(made, "upper"))[:, 0]
        np.testing.assert_allclose(moved.mean(), 1e-3, rtol=1e-3)


def test_refused(comm):
    bodies = {n: body(elastic(*SOFT)) for n in ("upper", "base")}
    with pytest.raises(CaseError, match="upper/base: method 'multipliers' has no friction"):
        problem(blocks(comm), bodies, {}, [Contact("upper", "base", "multipliers", friction=0.1)])


def test_the_key_of_a_case(comm):
    """A hot ring grips its core: friction keeps it from shortening as it would."""
    results = []
    for friction in (0.0, 0.3):
        data = ring({"time": {"end": 4.0, "fixed_step": 2.0}})
        data["interfaces"][0]["contact"] = {"friction": friction}
        results.append(final_state(comm, data))
    assert all(state.totals["casting/core.closed_fraction"] > 0.5 for state in results)
    axial = [abs(state.totals["casting/core.force.z"]) for state in results]
    assert axial[1] > axial[0] + 1.0


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_the_force_of_ejection_of_a_case(comm, method):
    """A core that is drawn out by its top bears μ Σ p S."""
    end = {"end": 2.0, "fixed_step": 1.0}
    data = merged(ring({"coupling": {"scheme": "mechanical"}}), {})
    for part in (*data["materials"].values(), *data["bodies"]):
        part["stress_free" if "density" in part else "temperature"] = 20.0
    data["interfaces"] = [{
        "bodies": ["casting", "core"],
        "contact": {"method": method, "friction": 0.15, "initial_gap": -2e-5},
    }]  # fmt: skip
    data["boundaries"] = [
        {"on": "casting/outside", "displacement": {"z": 0.0}},
        {"on": "core/top", "displacement": {"z": [[0.0, 0.0], [1.0, 0.0], [2.0, 1e-4]]}},
    ]
    data["time"] = end
    state = final_state(comm, data)
    pressure, pairs = state.paired("casting/core", "contact_pressure"), state.pairs["casting/core"]
    normal = comm.allreduce(float(pressure @ pairs.areas))
    assert normal > 1e4
    assert state.totals["casting/core.force.z"] == pytest.approx(0.15 * normal, rel=1e-6)


@pytest.mark.serial
def test_directions_by_hand():
    """Unit vectors; former ones where a motion vanishes or has turned back against them."""
    before = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0], [-1.0, 0.0]])
    vectors = np.array([[3.0, 4.0], [0.0, 0.0], [1e-9, -1e-9], [-2.0, 0.0]])
    expected = [[0.6, 0.8], [0.6, 0.8], [0.0, 1.0], [-1.0, 0.0]]
    np.testing.assert_allclose(forward(vectors, before), expected, rtol=1e-15)
    turned = [[0.6, 0.8], [0.6, 0.8], [0.5**0.5, -(0.5**0.5)], [-1.0, 0.0]]
    np.testing.assert_allclose(unit(vectors, before), turned, rtol=1e-15)


@pytest.mark.serial
def test_vectors_shortened_to_lengths_by_hand():
    """Over 5, the length of the vector, over 10, the one that is given, and over nothing."""
    vectors = np.array([[3.0, -4.0], [3.0, -4.0], [0.0, 0.0]])
    expected = [[0.6, -0.8], [0.3, -0.4], [0.0, 0.0]]
    found = shortened(vectors, np.array([2.0, 10.0, 0.0]))
    np.testing.assert_allclose(found, expected, rtol=1e-15)
