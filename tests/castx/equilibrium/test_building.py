"""Which procedure and which solver an equilibrium gets."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from castx.contact.choice import Contact
from castx.contact.methods.registry import names
from castx.equilibrium import building, linear_system
from castx.equilibrium.equilibrium import Equilibrium
from castx.equilibrium.fallback import FallbackMethods
from castx.materials.lookup import find_material
from castx.mechanics.body import BodyMechanics
from castx.mechanics.constitutive.law import Law
from castx.mechanics.q1p0 import Q1P0Formulation
from castx.mechanics.taylor_hood import TaylorHoodFormulation
from castx.solvers.inner.options import FACTORS
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import blocks, body, elastic, fixed, generated, problem, pushed
from tests.small_contact import SOFT, STIFF

pytestmark = pytest.mark.serial

BY_BLOCKS = names(lambda method: method.by_blocks)


def pressed(comm, contact: Contact, **settings):
    bodies = {
        "upper": body(elastic(*SOFT), loads=(pushed("top", 1e6),)), "base": body(elastic(*STIFF)),
    }  # fmt: skip
    return problem(
        blocks(comm, size=0.01), bodies, {"base": [fixed("bottom")]}, [contact], **settings
    )


@pytest.mark.parametrize("method", AT_ONCE)
def test_small_problems_are_solved_directly(comm, method):
    """One product with the factors for each Newton iteration."""
    made = pressed(comm, Contact("upper", "base", method), linear="automatic")
    report = made.equilibrium.solve(0.0)
    assert set(report.linear_solves) == {1} and not report.sweeps


@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
def test_factors_hold_all_of_the_stabilisation(comm, stabilisation):
    """A twisted block, whose pressures bend from cell to cell."""
    metal = body(
        elastic(SOFT[0], 0.499), loads=(pushed("far", 1e6),), stabilisation=stabilisation,
    )  # fmt: skip
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.02, width=0.01, size=2e-3)
    made = problem(mesh, {"casting": metal}, {"casting": [fixed("wall", "all")]}, tolerance=1e-9)
    assert made.equilibrium.solve(0.0).linear_solves == (1,)


def test_large_problems_are_solved_by_multigrid(comm, monkeypatch):
    monkeypatch.setitem(building.LARGEST_DIRECT, 2, 10)
    made = pressed(comm, Contact("upper", "base"), linear="automatic")
    assert max(made.equilibrium.solve(0.0).linear_solves) > 1


@pytest.mark.parametrize("melts", [False, True])
def test_large_quadratic_bodies_in_space_are_solved_on_two_levels(comm, monkeypatch, melts):
    """Those that may be liquid keep factors, as all do in the plane, whatever their size."""
    monkeypatch.setattr(building, "LARGEST_DIRECT_QUADRATIC", 10)
    monkeypatch.setitem(building.LARGEST_DIRECT, 2, 10)
    monkeypatch.setattr(BodyMechanics, "is_compressible", not melts)
    iterations = []
    for model in ("3d", "plane-strain"):
        mesh = generated(comm, model, "slab", ["casting"], length=0.02, width=0.01, size=0.01,
                         **({"depth": 0.01} if model == "3d" else {}))  # fmt: skip
        wall = body(elastic(*SOFT), formulation="taylor-hood", loads=(pushed("far", 1e6),))
        held = {"casting": [fixed("wall", "all")]}
        made = problem(mesh, {"casting": wall}, held, linear="automatic", tolerance=1e-6)
        iterations.append(max(made.equilibrium.solve(0.0).linear_solves))
    assert (iterations[0] > 1) != melts and iterations[1] == 1


def test_open_pairs_are_taken_apart_where_set_ups_are_rare(comm, monkeypatch):
    """In bodies that are elastic; a liquid is set up anew in every step."""
    monkeypatch.setitem(building.LARGEST_DIRECT, 2, 10)
    given, made = [], building.BlockSweep
    monkeypatch.setattr(
        building, "BlockSweep", lambda *parts: given.append(parts[3]) or made(*parts)
    )
    pressed(comm, Contact("upper", "base"), linear="automatic")
    monkeypatch.setattr(building.BodyAssembly, "is_elastic", False)
    pressed(comm, Contact("upper", "base"), linear="automatic")
    assert given[0] is not None and given[1] is None


@pytest.mark.parametrize("kind", ["flows", "yields as grains", "may be liquid"])
def test_a_body_that_flows_gets_factors_beside_the_multigrid_of_the_others(comm, monkeypatch, kind):
    """Where the choice is free, up to a size, and not beside multipliers, which leave it adrift.

    Multigrid of all bodies comes first. So it is with a body that may be liquid and is elastic.
    """
    monkeypatch.setitem(building.LARGEST_DIRECT, 2, 10)
    given = []

    def noting(made):
        return lambda *parts: given.append(parts[2]) or made(*parts)

    for solver in ("BlockSweep", "ArrowSchur"):
        monkeypatch.setattr(building, solver, noting(getattr(building, solver)))

    def chosen(method="condensed", linear="automatic"):
        given.clear()
        pressed(comm, Contact("upper", "base", method), linear=linear)
        return [[block.options is FACTORS for block in of_solver] for of_solver in given]

    by_multigrid = [False, False]
    assert chosen() == [by_multigrid]
    soft = property(lambda law: law.largest_shear_modulus() < 5e9)
    if kind == "flows":
        monkeypatch.setattr(Law, "flows_by_rate", soft)
    elif kind == "yields as grains":
        inner = building._inner_solvers

        def of_grains(*parts):
            with monkeypatch.context() as made:
                made.setattr(Law, "is_granular", soft)
                return inner(*parts)

        monkeypatch.setattr(building, "_inner_solvers", of_grains)
    else:
        solid = property(lambda body: body.name != "upper")
        monkeypatch.setattr(BodyMechanics, "is_compressible", solid)
    assert chosen() == [by_multigrid, [True, False]]
    assert chosen(linear="iterative") == chosen("multipliers") == [by_multigrid]
    monkeypatch.setattr(building, "LARGEST_FLOWING", 10)
    assert chosen() == [by_multigrid]


def test_bodies_that_all_have_factors_get_those_of_all_last(comm, monkeypatch):
    """Up to a size of all, and not beside multigrid of another body."""
    monkeypatch.setitem(building.LARGEST_DIRECT, 2, 10)
    given, direct = [], building.DirectSolver
    monkeypatch.setattr(
        building, "DirectSolver", lambda *parts: given.append(parts[1]) or direct(*parts)
    )

    def chosen():
        given.clear()
        return pressed(comm, Contact("upper", "base"), linear="automatic")

    soft = property(lambda law: law.largest_shear_modulus() < 5e9)
    monkeypatch.setattr(Law, "flows_by_rate", soft)
    chosen()
    assert given == []
    monkeypatch.setattr(Law, "flows_by_rate", True)
    unknowns = chosen().equilibrium.balance.assembly.layout.size_global
    assert given == [building.WHOLE_PREFIX]
    monkeypatch.setattr(building, "LARGEST_FLOWING", unknowns - 1)
    chosen()
    assert given == []


@pytest.mark.parametrize("whole", [True, False])
def test_slow_sweeps_over_bodies_end_in_factors_of_all(comm, monkeypatch, whole):
    """Each of two bodies is solved exactly, and a sweep over both is not."""
    monkeypatch.setitem(building.LARGEST_DIRECT, 2, 10)
    monkeypatch.setattr(Law, "flows_by_rate", True)
    monkeypatch.setattr(linear_system, "SLOW", 1)
    made = pressed(comm, Contact("upper", "base"), linear="automatic")
    if not whole:
        all_unknowns = made.equilibrium.balance.assembly.layout.size_global
        monkeypatch.setattr(building, "LARGEST_FLOWING", all_unknowns - 1)
        made = pressed(comm, Contact("upper", "base"), linear="automatic")
    linear = []
    for time in range(3):
        linear += made.equilibrium.solve(float(time)).linear_solves
        made.equilibrium.rewind()
    assert linear[0] > linear[1] == 2 and linear[2] == (1 if whole else 2)


def test_in_space_factors_pay_for_small_problems_q1p0_sand_and_quadratic_bodies():
    def largest(dimension, *formulations, law="thermo-elastic"):
        mesh = SimpleNamespace(mesh=SimpleNamespace(topology=SimpleNamespace(dim=dimension)))
        laws = [law, *["thermo-elastic"] * len(formulations[1:])]
        parts = [
            SimpleNamespace(
                mesh=mesh, formulation=made, is_compressible=True,
                material=SimpleNamespace(law=Law(find_material("sand-silica"), 20.0, name)),
            )
            for made, name in zip(formulations, laws, strict=True)
        ]  # fmt: skip
        return building.largest_direct(SimpleNamespace(parts=parts))

    q1p0 = object.__new__(Q1P0Formulation)
    assert largest(3, None, None) < largest(3, None, q1p0) < largest(2, None, None)
    assert largest(2, None, q1p0) == largest(2, None, None)
    sand = "drucker-prager"
    assert largest(3, None, None, law=sand) == largest(3, None, q1p0, law=sand) == 15_000
    assert largest(2, None, None, law=sand) == largest(2, None, None)
    quadratic = object.__new__(TaylorHoodFormulation)
    assert largest(3, None, quadratic) == 20_000
    assert largest(3, None, quadratic, law=sand) == 200_000


@pytest.mark.parametrize("method", BY_BLOCKS)
@pytest.mark.parametrize("solver", ["iteration", "preconditioner"])
def test_blocks_are_swept_or_precondition(comm, method, solver):
    settings = {"block_solver": solver, "block_iterations": 3}
    made = pressed(comm, Contact("upper", "base", method, settings=settings))
    report = made.equilibrium.solve(0.0)
    assert len(report.sweeps) == (3 if solver == "iteration" else 0)


def test_fallbacks_are_built_when_they_are_needed(comm):
    made = pressed(comm, Contact("upper", "base", fallback=("penalty",)))
    assert isinstance(made.equilibrium, FallbackMethods)
    assert isinstance(made.equilibrium.first, Equilibrium)
    assert isinstance(pressed(comm, Contact("upper", "base")).equilibrium, Equilibrium)


@pytest.mark.parametrize("support", [True, False])
def test_supports_can_be_left_out(comm, support):
    made = pressed(comm, Contact("upper", "base"), support=support)
    assert (made.equilibrium.balance.supports.motions is not None) == support


def test_bodies_that_contact_joins_stand_in_groups():
    """A rigid body joins none; without any contact all bodies are on firm springs by themselves."""
    bodies = SimpleNamespace(names=["die", "casting", "core", "pin", "lid"])
    contacts = [
        Contact("casting", "core"), Contact("die", "lid", "tied"), Contact("core", "sand", "rigid"),
        Contact("die", "sand", "rigid"),
    ]  # fmt: skip
    assert building._joined_by_contact(bodies, contacts) == [[0, 4], [1, 2], [3]]
    assert building._joined_by_contact(bodies, []) == []


def test_bodies_that_are_tied_or_stick_are_solved_together():
    """Those with unknowns of other kinds are not, nor those that slide."""
    bodies = SimpleNamespace(
        names=["die", "casting", "core", "pin"], parts=[None] * 4,
        layout=SimpleNamespace(block_sizes=[4, 4, 4, 3]),
    )  # fmt: skip
    contacts = [
        Contact("casting", "die", friction=0.1), Contact("casting", "core"),
        Contact("pin", "casting", friction=0.1),
    ]  # fmt: skip
    assert building._tied_together(bodies, contacts) == [[0, 1], [2], [3]]
    tied = [*contacts, Contact("core", "die", "tied")]
    assert building._tied_together(bodies, tied) == [[0, 1, 2], [3]]
