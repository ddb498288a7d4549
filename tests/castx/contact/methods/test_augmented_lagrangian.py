"""The augmented Lagrangian method: its keys, which all interfaces share but for the penalty."""

from __future__ import annotations

import pytest

from castx.contact.methods.augmented_lagrangian import METHOD
from castx.errors import CaseError

pytestmark = pytest.mark.serial
KEYS = {key.name: key for key in METHOD.keys}


def test_what_is_common_to_all_interfaces():
    assert {name: key.common for name, key in KEYS.items()} == {
        "penalty": False, "augmentation": True, "augmentations": True,
    }  # fmt: skip
    assert METHOD.updates_multipliers and not METHOD.exact
    assert (KEYS["augmentation"].default, KEYS["augmentations"].default) == ("loop", 30)


@pytest.mark.parametrize(
    "key, good, wrong", [("augmentation", "iteration", "never"), ("augmentations", 0, -1)]
)
def test_values(key, good, wrong):
    assert KEYS[key].kind.read(good) == good
    with pytest.raises(CaseError):
        KEYS[key].kind.read(wrong)
