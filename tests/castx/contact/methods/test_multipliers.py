"""Multipliers: bodies keep their displacements as unknowns, and there is no friction."""

from __future__ import annotations

import pytest

from castx.case.contact import BY_NODES, friction_problem
from castx.contact.choice import Contact
from castx.contact.kinematics.rows import Treatment
from castx.contact.methods.multipliers import METHOD

pytestmark = pytest.mark.serial


def test_the_bodies_are_left_alone():
    assert Contact("a", "b", METHOD.name).treatment is Treatment.UNCHANGED


def test_it_has_no_friction():
    found = friction_problem([METHOD.name], BY_NODES, 0.2)
    assert found.startswith("method 'multipliers' has no friction; those that have: condensed")
    assert friction_problem([METHOD.name], BY_NODES, 0.0) == ""
