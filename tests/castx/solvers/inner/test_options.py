"""Which systems are solved by factors."""

from __future__ import annotations

import pytest

from castx.solvers.inner.options import solves_directly

pytestmark = pytest.mark.serial


def test_the_size_decides_unless_the_user_does():
    assert solves_directly("automatic", 10, 10) and not solves_directly("automatic", 11, 10)
    assert solves_directly("direct", 11, 10) and not solves_directly("iterative", 1, 10)
