"""The condensed method: exact, with friction, the default and without keys of its own."""

from __future__ import annotations

import pytest

from castx.case.contact import InterfaceContact
from castx.contact.choice import Contact, common_method
from castx.contact.kinematics.rows import Treatment
from castx.contact.methods.condensed import METHOD

pytestmark = pytest.mark.serial


def test_it_is_the_default():
    assert InterfaceContact.read({}).method == METHOD.name
    assert common_method([]) is METHOD


def test_motions_along_the_surface_are_unknowns_with_friction():
    assert Contact("a", "b").treatment is Treatment.CONDENSED
    assert Contact("a", "b", friction=0.1).treatment is Treatment.SLIDING
