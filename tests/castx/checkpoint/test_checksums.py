"""Checksums of parts give that of the whole."""

from __future__ import annotations

import zlib
from itertools import pairwise

import numpy as np
import pytest

from castx.checkpoint.checksums import shifted

pytestmark = pytest.mark.serial

WHOLE = np.random.default_rng(2).integers(0, 256, 5000, dtype=np.uint8).tobytes()


@pytest.mark.parametrize("cuts", [(), (0,), (1,), (4999,), (17, 17, 1024, 4000)])
def test_parts_add_up_to_the_checksum_that_zlib_finds(cuts):
    total = 0
    for begin, end in pairwise((0, *cuts, len(WHOLE))):
        total ^= shifted(zlib.crc32(WHOLE[begin:end]), len(WHOLE) - end)
    assert total == zlib.crc32(WHOLE)


def test_a_part_far_from_the_end_counts_as_if_shifted_in_steps():
    """Files are larger than what 32 bits count."""
    far = 3 * 2**40 + 5
    assert shifted(shifted(12345, far - 7), 7) == shifted(12345, far) != 12345
