"""Every target has a writer, and the command names all of them."""

import pytest

from castx.handover.export import WRITERS
from castx.handover.target import Target

pytestmark = pytest.mark.serial


def test_every_target_has_a_writer():
    assert set(WRITERS) == set(Target)
