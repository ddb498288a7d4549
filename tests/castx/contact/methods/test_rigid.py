"""The rigid method: the equations of the condensed one, a rigid primary body, no fallback."""

from __future__ import annotations

import pytest

from castx.case.contact import body_problem
from castx.contact.choice import Contact, check_bodies, common_method
from castx.contact.methods.condensed import METHOD as CONDENSED
from castx.contact.methods.rigid import METHOD
from castx.errors import CaseError

pytestmark = pytest.mark.serial


def test_it_is_solved_as_condensed_contact():
    assert common_method([Contact("a", "b", "rigid"), Contact("a", "c")]) is CONDENSED


def test_it_needs_a_rigid_primary_body():
    assert body_problem(METHOD.name, "a", "b", ["b"]) == ""
    assert "needs a rigid primary body" in body_problem(METHOD.name, "a", "b", [])
    with pytest.raises(CaseError, match="interface a/b: needs a rigid primary body"):
        check_bodies([Contact("a", "b", METHOD.name)], ["a", "b"])
