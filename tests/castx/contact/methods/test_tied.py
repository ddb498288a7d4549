"""The tied method: goes with every other one and has no fallback."""

from __future__ import annotations

import pytest

from castx.contact.choice import Contact, common_method, fallbacks
from castx.contact.kinematics.rows import Treatment
from castx.contact.methods.registry import METHODS
from castx.contact.methods.tied import METHOD
from tests.contact_methods import TWO_BODIES

pytestmark = pytest.mark.serial
TIED = Contact("a", "b", METHOD.name)


@pytest.mark.parametrize("method", TWO_BODIES)
def test_it_goes_with_every_method(method):
    assert common_method([TIED, Contact("a", "c", method)]) is METHODS[method]


def test_it_stays_tied_when_another_method_takes_over():
    both = [TIED, Contact("a", "c", fallback=("multipliers",))]
    [(name, [tied, other])] = fallbacks(both)
    assert (name, tied, other.method) == ("multipliers", TIED, "multipliers")
    assert TIED.treatment is Treatment.TIED
