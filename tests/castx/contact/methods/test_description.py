"""What a method says about itself: which keys it uses."""

from __future__ import annotations

import pytest

from castx.contact.methods.description import ContactMethod, Key, UnknownKind
from castx.input.entries import Whole

pytestmark = pytest.mark.serial


def test_a_method_uses_its_own_keys_only():
    key = Key("sweeps", Whole(1, 9), 3, "Sweeps of one solve.")
    method = ContactMethod("new", "s", "f", "p", "a", UnknownKind.MULTIPLIERS, keys=(key,))
    assert method.uses("sweeps")
    assert not method.uses("penalty")
