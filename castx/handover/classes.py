"""Classes of a quantity that varies from element to element, for programs without such fields."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, IntArray

MOST = 20
"""Largest number of classes."""
SAME = 1e-9
"""Range, beside the largest value, below which all values are one class."""


@dataclass(frozen=True, eq=False)
class Classes:
    """Classes of equal width between the smallest and the largest value.

    Attributes:
        quantity: what is divided.
        numbers: class of each element from 0 on, (elements,); -1 where there is no value.
        width: of a class.
        middles: of the classes, (classes,).
    """

    quantity: str
    numbers: IntArray
    width: float
    middles: FloatArray

    @classmethod
    def of(cls, quantity: str, values: FloatArray, most: int = MOST) -> Classes:
        """Return the classes of values.

        Args:
            quantity: what is divided.
            values: of the elements, not a number where there is none, (elements,).
            most: largest number of classes.
        """
        known = np.isfinite(values)
        numbers = np.full(len(values), -1, dtype=np.int32)
        if not known.any():
            return cls(quantity, numbers, 0.0, np.empty(0))
        least, largest = float(values[known].min()), float(values[known].max())
        if largest - least <= SAME * max(abs(least), abs(largest)):
            numbers[known] = 0
            return cls(quantity, numbers, 0.0, np.array([0.5 * (least + largest)]))
        width = (largest - least) / most
        place = ((values[known] - least) / width).astype(np.int32)
        numbers[known] = np.minimum(place, most - 1)
        return cls(quantity, numbers, width, least + width * (0.5 + np.arange(most)))
