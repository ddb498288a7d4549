"""Arrays as text in a page: whole numbers of 16 bits or floats, compressed, in base64."""

from __future__ import annotations

import zlib
from base64 import b64decode, b64encode
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray

LEVELS = 65534
"""Steps between the least and the largest value; 0 stands for no number, values begin at 1."""


def packed(array: npt.NDArray[Any]) -> dict[str, Any]:
    """Return an array as type, shape and text.

    Args:
        array: whole numbers or float32, any shape; 64 bits are made 32.
    """
    narrow = {"f": np.float32, "u": np.uint32, "i": np.uint32}[array.dtype.kind]
    small = array if array.dtype == np.uint16 else array.astype(narrow)
    return {"type": small.dtype.name, "shape": list(small.shape), "data": text_of(small)}


def text_of(array: npt.NDArray[Any]) -> str:
    """Return the bytes of an array, little endian, compressed by zlib, in base64."""
    little = np.ascontiguousarray(array.astype(array.dtype.newbyteorder("<"), copy=False))
    return b64encode(zlib.compress(little.tobytes(), 6)).decode("ascii")


def packed_values(values: FloatArray) -> dict[str, Any]:
    """Return a field at several moments as whole numbers of 16 bits between its extremes.

    Each moment holds the differences to the one before it, modulo 2^16; lower bytes of all come
    first, then the higher ones: both compress better so. The error is at most half a step,
    (high - low)/LEVELS/2, beside that of a float of 32 bits.

    Args:
        values: (moments, n); not a number where there is nothing.
    """
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    scale = LEVELS / (high - low) if high > low else 0.0
    levels = np.zeros(values.shape, dtype=np.uint16)
    known = np.isfinite(values)
    levels[known] = (1.0 + np.rint(scale * (values[known] - low))).astype(np.uint16)
    steps = levels.copy()
    steps[1:] -= levels[:-1]  # wraps round, as the page does
    planes = np.frombuffer(steps.astype("<u2").tobytes(), dtype=np.uint8).reshape(-1, 2).T
    return {
        "type": "levels",
        "shape": list(values.shape),
        "low": low,
        "high": high,
        "data": text_of(planes),
    }


def unpacked(found: Mapping[str, Any]) -> npt.NDArray[Any]:
    """Return an array or a field from its text, as the page does."""
    content = zlib.decompress(b64decode(found["data"]))
    shape = found["shape"]
    if found["type"] != "levels":
        kind = np.dtype(found["type"]).newbyteorder("<")
        return np.frombuffer(content, dtype=kind).reshape(shape)
    planes = np.frombuffer(content, dtype=np.uint8).reshape(2, -1).astype(np.uint16)
    steps = (planes[0] + 256 * planes[1]).reshape(shape)
    levels = np.cumsum(steps, axis=0, dtype=np.uint16)
    values = found["low"] + (levels - 1.0) * (found["high"] - found["low"]) / LEVELS
    return np.where(levels == 0, np.nan, values)
