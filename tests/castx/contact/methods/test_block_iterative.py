"""The block-iterative method: its keys, which all interfaces share but for the penalty."""

from __future__ import annotations

import pytest

from castx.contact.methods.block_iterative import METHOD
from castx.errors import CaseError

pytestmark = pytest.mark.serial
KEYS = {key.name: key for key in METHOD.keys}


def test_what_is_common_to_all_interfaces():
    assert [name for name, key in KEYS.items() if not key.common] == ["penalty"]
    assert METHOD.by_blocks


@pytest.mark.parametrize(
    "key, good, wrong",
    [
        ("blocks", "interface", "nodes"),
        ("block_solver", "preconditioner", "direct"),
        ("block_iterations", 1, 0),
    ],
)
def test_values(key, good, wrong):
    assert KEYS[key].kind.read(good) == good
    with pytest.raises(CaseError):
        KEYS[key].kind.read(wrong)
