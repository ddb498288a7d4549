"""Which procedure and which solver an equilibrium gets."""

from __future__ import annotations

import pytest

from castx.contact.choice import Contact
from castx.contact.methods.registry import names
from castx.equilibrium.equilibrium import Equilibrium
from castx.equilibrium.fallback import FallbackMethods
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import blocks, body, elastic, fixed, problem, pushed
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
