"""Checksum of bytes whose parts lie on several ranks: CRC-32 as zlib and zip files have it.

CRC-32 is linear: that of A followed by B is crc(A) x^(8 |B|) + crc(B), a sum and a product of
polynomials over the numbers 0 and 1, modulo that of CRC-32 (M. Adler, `crc32_combine` of zlib). So
each rank shifts the checksum of its part past all bytes that follow, and exclusive or over the
ranks is the checksum of the whole.
"""

from __future__ import annotations

from functools import cache

_POLYNOMIAL = 0xEDB88320
"""That of CRC-32 without x^32; the highest bit of a number is its term x^0."""
_ONE, _BYTE = 1 << 31, 1 << 23


def shifted(checksum: int, following: int) -> int:
    """Return the share of a part in the checksum of the whole.

    Args:
        checksum: CRC-32 of the part.
        following: bytes of the whole behind the part.
    """
    return _product(_power(following), checksum)


def _product(a: int, b: int) -> int:
    result = 0
    while a:
        if a & _ONE:
            result ^= b
        a = (a << 1) & 0xFFFFFFFF
        b = (b >> 1) ^ (_POLYNOMIAL if b & 1 else 0)
    return result


@cache
def _power(count: int) -> int:
    """Return x^(8 count)."""
    result, square = _ONE, _BYTE
    while count:
        if count & 1:
            result = _product(result, square)
        square = _product(square, square)
        count >>= 1
    return result
