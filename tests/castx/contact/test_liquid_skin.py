"""Liquid follows the wall, its skin leaves it without stress, and what melts again comes back."""

from __future__ import annotations

from dataclasses import replace

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact
from castx.contact.liquid_skin import LiquidSkin
from castx.contact.methods.registry import METHODS
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.mechanics.mush.metal import MushMetal
from castx.tables import Table
from tests.castx.domain.pairs.test_face_pairs import separate
from tests.contact_methods import (
    AT_ONCE,
    EXACT,
    FORCE_OF_GAP,
    TWO_BODIES,
    WITH_FRICTION,
    WITH_RIGID_BODIES,
    sharp,
)
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    problem,
)

pytestmark = pytest.mark.sampled

WIDTH, HEIGHT, VISCOSITY, PULL = 0.01, 0.03, 1e6, 1e-5
"""Of half the upper block [m], viscosity [Pa s], motion of the base in a step of 1 s [m]."""
ALLOY = {
    "latent_heat": 4e5, "solidus": 560.0, "liquidus": 610.0, "stress_free": 560.0,
    "liquid": {"model": "viscous", "viscosity": VISCOSITY, "coherency": 0.7},
}  # fmt: skip
MUSH = MushMetal(0.0, 1e-3, 2e4, 0.98, 1.0, 0.0, 610.0)
"""Melt that bears 20 kPa and flows freely, from all surfaces, of an alloy that does not shrink."""
LIQUID, SOLID = (650.0, 0.0), (560.0, 1.0)
VISCOUS_FORCE = 4 * VISCOSITY * PULL / HEIGHT * WIDTH
"""Of a viscous bar stretched in plane strain [N]: σ = 4 η ε̇."""
ORDERS = [("upper", "base"), ("base", "upper")]
HARD = sharp(AT_ONCE)


def drawn_apart(
    comm, order=ORDERS[0], method="condensed", alloy=ALLOY, model="plane-strain", mush=None,
    **contact,
):  # fmt: skip
    """Return a block that is held above, on a base that sinks by 10 µm a second."""
    bodies = {
        "upper": body(elastic(7e9, 0.33, **alloy), starts_liquid=True, mush=mush),
        "base": body(elastic(70e12, 0.3)),
    }
    down = SurfaceDisplacement("bottom", "normal", Table((0.0, 9.0), (0.0, 9 * PULL)))
    conditions = {"upper": [fixed("top")], "base": [down]}
    return problem(blocks(comm, model), bodies, conditions, [Contact(*order, method, **contact)])


def step(made, time, state, base=None):
    """Bring the upper block into a state, temperature [°C] and solid fraction, for one step."""
    states = tried(made, time, state, base)
    made.equilibrium.commit()
    return states[0]


def tried(made, time, state, base=None):
    """Solve a step of `step` and return the states of the pairs of all interfaces."""
    for name, part in made.bodies.items():
        count = len(part.mesh.parent_vertices)
        temperature, fraction = state if name == "upper" else base or (20.0, 1.0)
        fractions = fraction(part.mesh.points) if callable(fraction) else np.full(count, fraction)
        part.update_state(np.full(count, temperature), fractions, 1.0)
    made.equilibrium.solve(time)
    return made.contact_states()


def relief(stretched: float) -> float:
    """Return what a bar shrinks that was born under the pull of the liquid, once it is free [m].

    Of the mean stress 2 η ε̇; in plane strain by 1 + ν', with half of G and of 1/K in the step in
    which it is born.
    """
    K, G = 7e9 / (3 * (1 - 2 * 0.33)) / 0.5, 0.5 * 7e9 / (2 * 1.33)
    poisson = (3 * K - 2 * G) / (2 * (3 * K + G))
    return (1 + poisson) * 2 * VISCOSITY * stretched / (3 * K)


def total(comm, state):
    return float(comm.allreduce(state.force[:, 1].sum()))


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("method", TWO_BODIES)
def test_liquid_follows_its_wall_and_the_skin_leaves_it(comm, method, order):
    """A liquid bar is drawn out with the force 4 η ε̇ A, a frozen one stays where it froze."""
    made = drawn_apart(comm, order, method)
    first = step(made, 1.0, LIQUID)
    assert comm.allreduce(int(np.count_nonzero(~first.closed))) == 0
    assert np.all(first.pressure < 1e-6)
    soft = method in FORCE_OF_GAP and method not in HARD
    stretched = PULL - max(comm.allgather(float(first.gap.max(initial=-1.0))))
    if not soft:
        sign = -1.0 if order == ORDERS[0] else 1.0
        force = sign * VISCOUS_FORCE * stretched / PULL
        assert total(comm, first) == pytest.approx(force, rel=1e-3)
        assert stretched == pytest.approx(PULL, rel=1e-6 if method in EXACT else 0.03)
    frozen = step(made, 2.0, SOLID)
    np.testing.assert_allclose(frozen.gap, 2 * PULL - stretched + relief(stretched), rtol=1e-5)
    assert not frozen.closed.any()
    assert total(comm, frozen) == pytest.approx(0.0, abs=1e-9)
    # A solid would have been drawn by 2 MPa to follow.
    assert np.abs(made.bodies["upper"].stress()[:, [0, 1, 3]]).max() < 1.0
    molten = step(made, 2.0, LIQUID)
    assert molten.closed.all()
    if not soft:
        np.testing.assert_allclose(molten.gap, 0.0, atol=1e-12 if method in EXACT else 3e-7)


@pytest.mark.parametrize("method", sharp(WITH_RIGID_BODIES))
def test_liquid_follows_a_rigid_wall_and_the_skin_leaves_it(comm, method):
    """The same against a wall without unknowns or liquid of its own, from which the top moves."""
    up = SurfaceDisplacement("top", "normal", Table((0.0, 9.0), (0.0, 9 * PULL)))
    bodies = {"upper": body(elastic(7e9, 0.33, **ALLOY), starts_liquid=True)}
    made = problem(blocks(comm), bodies, {"upper": [up]}, [Contact("upper", "base", method)])
    exact = METHODS[method].exact
    first = step(made, 1.0, LIQUID)
    assert comm.allreduce(int(np.count_nonzero(~first.closed))) == 0
    assert np.all(first.pressure < 1e-6)
    np.testing.assert_allclose(first.gap, 0.0, atol=1e-12 if exact else 3e-7)
    stretched = PULL - max(comm.allgather(float(first.gap.max(initial=-1.0))))
    expected = -VISCOUS_FORCE * stretched / PULL
    assert total(comm, first) == pytest.approx(expected, rel=1e-3)
    frozen = step(made, 2.0, SOLID)
    assert not frozen.closed.any()
    np.testing.assert_allclose(frozen.gap, 2 * PULL - stretched + relief(stretched), rtol=1e-5)
    assert np.abs(made.bodies["upper"].stress()[:, [0, 1, 3]]).max() < 1.0
    assert step(made, 2.0, LIQUID).closed.all()


@pytest.mark.ranks
@pytest.mark.parametrize("order", ORDERS)
def test_a_skin_grows_by_what_begins_to_bear_at_closed_pairs(comm, order):
    """Mush bears from 0.7 to 1: w = 0.5 at f_s = 0.85. Open pairs do not count."""
    made = drawn_apart(comm, order)
    grown = []
    for fraction in (0.5, 0.85, 0.85, lambda x: np.where(x[:, 0] < WIDTH / 2, 1.0, 0.85), 1.0):
        tried(made, 0.0, (560.0, fraction))
        grown.append(made.skin_growth())
        made.equilibrium.commit()
    np.testing.assert_allclose(grown[:3], [0.0, 0.5, 0.0], atol=1e-12)
    assert 0.1 < grown[3] < 0.4 and grown[3] + grown[4] == pytest.approx(0.5, rel=1e-12)
    assert not step(made, 1.0, (560.0, 1.0)).closed.any()
    tried(made, 1.0, (560.0, 0.85))
    assert made.skin_growth() == 0.0


@pytest.mark.serial
def test_a_given_gap_stays_open(comm):
    """There is no metal at a wall that is away from it from the start."""
    made = drawn_apart(comm, initial_gap=lambda x: np.full(len(x), 5e-6))
    state = step(made, 1.0, LIQUID)
    np.testing.assert_allclose(state.gap, 5e-6 + PULL, rtol=1e-6)
    assert not state.closed.any()


@pytest.mark.serial
def test_a_body_that_never_is_a_liquid_is_free(comm):
    alloy = {name: value for name, value in ALLOY.items() if name != "liquid"}
    state = step(drawn_apart(comm, alloy=alloy), 1.0, LIQUID)
    np.testing.assert_allclose(state.gap, PULL, rtol=1e-4)


@pytest.mark.serial
def test_both_sides_have_to_be_coherent(comm):
    mesh = blocks(comm)
    down = SurfaceDisplacement("bottom", "normal", Table((0.0, 9.0), (0.0, 9 * PULL)))
    metal = elastic(7e9, 0.33, **ALLOY)
    bodies = {name: body(metal, starts_liquid=True) for name in ("upper", "base")}
    held = {"upper": [fixed("top")], "base": [down]}
    for upper, base, closed in (
        (SOLID, LIQUID, True), (LIQUID, SOLID, True), (SOLID, SOLID, False)
    ):  # fmt: skip
        made = problem(mesh, bodies, held, [Contact("upper", "base")])
        step(made, 0.0, upper, base)
        assert step(made, 1.0, upper, base).closed.all() == closed


@pytest.mark.ranks
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_the_share_of_a_node_decides_how_far_its_pair_is_pulled(comm, order, model):
    """p_v S (1 − w)/w, with the atmosphere where no depression is given."""
    for given, depression in ({}, 1.01e5), ({"cavitation": 2e4}, 2e4):
        made = drawn_apart(comm, order, model=model, alloy={**ALLOY, **given})
        part = made.bodies["upper"]

        def fraction(points):
            return np.clip(0.6 + 50.0 * points[:, 0], 0.0, 1.0)

        part.update_state(np.full(len(part.mesh.points), 600.0), fraction(part.mesh.points), 1.0)
        skin, gaps = LiquidSkin(made.layout, list(made.bodies.values()), made.gaps), made.gaps
        pulls, _ = skin.pulls()
        index = gaps.interfaces[0].index
        share = np.clip((fraction(made.pairs[0].points[index]) - 0.7) / 0.3, 0.0, 1.0)
        with np.errstate(divide="ignore"):
            expected = (1 - share) / share * depression * gaps.areas
        np.testing.assert_allclose(pulls, np.where(gaps.free, expected, 0.0), rtol=1e-9)
        spread = everywhere(comm, share)
        assert spread.min() == 0.0 and spread.max() > 0.0
        skin.destroy()


@pytest.mark.serial
def test_a_node_between_two_others_is_pulled_as_the_one_that_bears_more(comm, tmp_path):
    """Nodes of a base in four face facets of a metal in three, whose share rises with x."""
    width, facets = 0.02, 3
    mesh = separate(comm, tmp_path, facets, 4)
    bodies = {
        "upper": body(elastic(7e9, 0.33, **ALLOY), starts_liquid=True),
        "base": body(elastic(70e12, 0.3)),
    }
    facing = Pairing(kind="node-to-face", surfaces=("over", "under"))
    held = {"upper": [fixed("top")], "base": [fixed("bottom")]}
    made = problem(mesh, bodies, held, [Contact("base", "upper", pairing=facing)])

    def fraction(x):
        return 0.75 + 0.2 * x / width

    part = made.bodies["upper"]
    part.update_state(np.full(len(part.mesh.points), 600.0), fraction(part.mesh.points[:, 0]), 1.0)
    skin, gaps = LiquidSkin(made.layout, list(made.bodies.values()), made.gaps), made.gaps
    x = made.pairs[0].points[gaps.interfaces[0].index][:, 0]
    corner = np.ceil(x / width * facets - 1e-6) / facets * width
    share = (fraction(corner) - 0.7) / 0.3
    expected = np.where(gaps.free, (1 - share) / share * 1.01e5 * gaps.areas, 0.0)
    assert np.unique(corner).size > 2 and (corner > x + 1e-4).any()
    np.testing.assert_allclose(skin.pulls()[0], expected, rtol=1e-9)
    skin.destroy()


@pytest.mark.serial
def test_a_skin_half_solid_bears_half_the_pull(comm):
    """Drawn by 10 µm, it pulls with w E' ε; below p_v (1 − w)/w it follows, else it is free."""
    w, poisson = 0.5, 0.33
    G, K = 7e9 / (2 * (1 + poisson)), 7e9 / (3 * (1 - 2 * poisson))
    soft, stiff = w * G, K / w
    young = 9 * stiff * soft / (3 * stiff + soft)
    own = (3 * stiff - 2 * soft) / (6 * stiff + 2 * soft)
    pull = young / (1 - own**2) * PULL / HEIGHT
    for factor, closed in ((1.02, True), (0.98, False)):
        liquid = {**ALLOY["liquid"], "viscosity": 1.0}
        alloy = {**ALLOY, "cavitation": factor * pull, "liquid": liquid}
        made = drawn_apart(comm, alloy=alloy)
        step(made, 0.0, (590.0, 0.85))
        state = step(made, 1.0, (590.0, 0.85))
        assert state.closed.all() == state.closed.any() == closed
        if closed:
            assert total(comm, state) == pytest.approx(-pull * WIDTH, rel=1e-3)
        else:
            np.testing.assert_allclose(state.gap, PULL, rtol=1e-4)


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_pressure_alone_brings_back_the_melt_of_a_mush(comm, model):
    """A bar that has let go stays away as it melts, where one without flow is put back."""
    for mush in (None, MUSH):
        made = drawn_apart(comm, model=model, mush=mush)
        step(made, 0.0, SOLID)
        apart = step(made, 1.0, SOLID)
        assert not apart.closed.any()
        molten = step(made, 1.0, LIQUID)
        assert (molten.closed == (mush is None)).all()
        if mush is not None:
            np.testing.assert_allclose(molten.gap, apart.gap, atol=1e-3 * PULL)


@pytest.mark.ranks
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_melt_comes_back_to_its_wall_where_all_round_it_has_melted(comm, order, model):
    """Pairs stand at 0, 5 and 10 mm: one beside what bears stays away from the wall."""
    made = drawn_apart(comm, order, model=model)
    step(made, 0.0, SOLID)
    assert not step(made, 1.0, SOLID).closed.any()
    for melted, closed in ((0.002, 0.0), (0.007, 0.002), (0.02, 0.02)):

        def fraction(points, end=melted):
            return np.where(points[:, 0] < end, 0.0, 1.0)

        found, index = step(made, 1.0, (600.0, fraction)).closed, made.gaps.interfaces[0].index
        np.testing.assert_array_equal(found, made.pairs[0].points[index, 0] < closed)


def alloy_of(coherency):
    """Return the alloy with another coherency."""
    return ALLOY | {"liquid": {**ALLOY["liquid"], "coherency": coherency}}


@pytest.mark.ranks
@pytest.mark.parametrize("coherency", [0.7, 0.95, 0.99])
def test_melt_of_a_mush_bears_the_same_pull_at_every_coherency(comm, coherency):
    """A bar of f = 0.97 is drawn with w G ε, up to Δp_c; liquid beyond it too.

    Its melt follows without pressure, and its skeleton resists by its deviator alone.
    """
    share = max(0.0, (0.97 - coherency) / (1.0 - coherency))
    stiffness = share * 7e9 / (2 * 1.33) / HEIGHT
    for factor in (0.98, 1.02):
        made = drawn_apart(comm, alloy=alloy_of(coherency), mush=MUSH)
        step(made, 0.0, (565.0, 0.97))
        sinks = factor * MUSH.cavitation / stiffness if share else PULL
        state = step(made, sinks / PULL, (565.0, 0.97))
        holds = factor < 1.0 or share == 0.0
        assert (state.closed == holds).all()
        if holds and share:
            pull = -total(comm, state) / WIDTH
            assert pull == pytest.approx(factor * MUSH.cavitation, rel=1e-3)
        elif not holds:
            np.testing.assert_allclose(state.gap, sinks, rtol=1e-4)


@pytest.mark.serial
def test_liquid_of_a_mush_follows_its_wall_beyond_what_its_melt_bears(comm):
    """A bar of 100 MPa s, drawn by η ε̇ = 33 kPa of its deviator alone, with Δp_c of 20 kPa."""
    alloy = ALLOY | {"liquid": {**ALLOY["liquid"], "viscosity": 1e8}}
    made = drawn_apart(comm, alloy=alloy, mush=MUSH)
    state = step(made, 1.0, LIQUID)
    assert state.closed.all()
    pull = 1e8 * PULL / HEIGHT
    assert pull > 1.5 * MUSH.cavitation
    assert total(comm, state) == pytest.approx(-pull * WIDTH, rel=1e-5)


@pytest.mark.ranks
def test_a_void_in_the_melt_at_a_wall_is_a_gap(comm):
    """Stretched across, a bar opens pores, and is pulled by less than Δp_c, since s is −2wGε/3."""
    stretch, unfed = Table((0.0, 9.0), (0.0, 9e-7)), replace(MUSH, feeders=())
    bodies = {
        "upper": body(elastic(7e9, 0.33, **ALLOY), starts_liquid=True, mush=unfed),
        "base": body(elastic(70e12, 0.3)),
    }
    wide = SurfaceDisplacement("side", "normal", stretch)
    held = {"upper": [fixed("top"), wide], "base": [fixed("bottom")]}
    made = problem(blocks(comm), bodies, held, [Contact(*ORDERS[0])])
    step(made, 0.0, (565.0, 0.97))
    state, upper = step(made, 1.0, (565.0, 0.97)), made.bodies["upper"]
    skeleton = -2 / 3 * 0.9 * 7e9 / (2 * 1.33) * 1e-7 / WIDTH
    pull = MUSH.cavitation + skeleton
    assert state.closed.all() and total(comm, state) == pytest.approx(-pull * WIDTH, rel=1e-3)
    assert comm.allreduce(float(upper.pores().min(initial=1.0)), MPI.MIN) > 0.0
    state = step(made, 1.1, (565.0, 0.97))
    assert not state.closed.any()
    assert comm.allreduce(float(state.gap.min(initial=1.0)), MPI.MIN) > 1e-9


@pytest.mark.ranks
def test_the_last_melt_of_a_mush_counts_as_growth_of_a_skin(comm):
    """From f = 0.9 to 0.999 with g_c = 0.02 a twentieth is left, while w grows by a third.

    From 0.75 to 0.9 w grows by a half, with all of the last melt left.
    """
    made = drawn_apart(comm, mush=MUSH)
    grown = []
    for fraction in (0.75, 0.9, 0.9, 0.999):
        tried(made, 0.0, (565.0, fraction))
        grown.append(made.skin_growth())
        made.equilibrium.commit()
    np.testing.assert_allclose(grown[1:], [0.5, 0.0, 1.0 - np.cbrt(0.05)], atol=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize("method", sharp(WITH_FRICTION))
def test_a_liquid_rubs_at_no_wall(comm, method):
    """Pressed on its base and pushed sideways, a solid bears friction and a liquid none."""
    friction = {}
    for name, state in (("liquid", LIQUID), ("solid", SOLID)):
        bodies = {
            "upper": body(elastic(7e9, 0.33, **ALLOY), starts_liquid=True),
            "base": body(elastic(70e9, 0.3)),
        }
        conditions = {
            "upper": [fixed("top", "normal", -1e-6), fixed("top", "x", 1e-6)],
            "base": [fixed("bottom", "all")],
        }
        contact = Contact("upper", "base", method, friction=0.3)
        made = problem(blocks(comm, symmetry=False), bodies, conditions, [contact])
        state = step(made, 1.0, state)
        friction[name] = abs(state.force[:, 0].sum())
        assert state.force[:, 1].sum() > 1.0
    assert friction["liquid"] < 1e-9
    assert friction["solid"] > 1.0


@pytest.mark.serial
@pytest.mark.parametrize("order", ORDERS)
def test_of_two_liquids_at_a_pair_the_higher_column_presses(comm, order):
    """The lower one begins at the pair, where its own column has no height."""
    metal, weight = elastic(7e9, 0.33, **ALLOY), (0.0, -7000.0 * 9.81)
    liquid = body(metal, starts_liquid=True, body_force=weight)
    held = {"upper": [fixed("top")], "base": [fixed("bottom")]}
    made = problem(blocks(comm), {"upper": liquid, "base": liquid}, held, [Contact(*order)])
    step(made, 1.0, LIQUID, LIQUID)
    pressures = made.equilibrium.balance.skin.pressures()
    assert pressures.size
    np.testing.assert_allclose(pressures, 7000.0 * 9.81 * HEIGHT, rtol=1e-12)


@pytest.mark.ranks
@pytest.mark.parametrize("formulation", ["mixed", "q1p0"])
@pytest.mark.parametrize("order", ORDERS)
def test_the_pressure_is_at_least_that_of_the_column(comm, order, formulation):
    """Of 7000 kg/m³ under gravity, a wall that gives way feels ρ g h all the same."""
    weight, cells = -7000.0 * 9.81, "quadrilaterals" if formulation == "q1p0" else "simplices"
    mesh = generated(
        comm, "plane-strain", "stacked_blocks", ["upper", "base"], upper=[0.02, HEIGHT],
        base=[0.02, 0.02], size=0.005, cells=cells,
    )  # fmt: skip
    bodies = {
        "upper": body(
            elastic(7e9, 0.33, **ALLOY), starts_liquid=True, formulation=formulation,
            body_force=(0.0, weight),
        ),
        "base": body(elastic(70e12, 0.3), formulation=formulation),
    }  # fmt: skip
    down = SurfaceDisplacement("bottom", "normal", Table((0.0, 9.0), (0.0, 900 * PULL)))
    conditions = {"upper": [fixed("side"), fixed("top")], "base": [down]}
    made = problem(mesh, bodies, conditions, [Contact(*order)])
    state = step(made, 1.0, LIQUID)
    assert total(comm, state) * (1 if order == ORDERS[0] else -1) < -100.0
    np.testing.assert_allclose(everywhere(comm, state.pressure), -weight * HEIGHT, rtol=1e-12)
