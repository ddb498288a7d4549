"""Positions of nodes along a line, uniform or growing away from an interface."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from castx.arrays import FloatArray


@dataclass(frozen=True)
class Sizing:
    """Wanted element size over the distance d from the interface.

    size(d) = interface_size + (size - interface_size) (d / extent)^order_of_growth, where the
    extent is that of the body away from its interface; `size` everywhere without an interface_size.

    Args:
        size: largest element size [m].
        interface_size: size at the interface [m], or None.
        order_of_growth: 1 grows linearly with the distance; larger stays fine for longer.
    """

    size: float
    interface_size: float | None = None
    order_of_growth: float = 1.0

    def __post_init__(self) -> None:
        """Refuse sizes that make no mesh."""
        if not self.size > 0:
            raise ValueError(f"size must be positive, got {self.size:g} m")
        if self.interface_size is not None and not 0 < self.interface_size <= self.size:
            raise ValueError(
                f"interface_size must be positive and at most the size of {self.size:g} m, "
                f"got {self.interface_size:g} m"
            )
        if not self.order_of_growth > 0:
            raise ValueError(f"order_of_growth must be positive, got {self.order_of_growth:g}")

    def at(self, distance: FloatArray, extent: float) -> FloatArray:
        """Return the wanted sizes at distances from the interface [m].

        Args:
            distance: from the interface [m].
            extent: of the body away from its interface [m].
        """
        finest = self.size if self.interface_size is None else self.interface_size
        growth = (distance / extent) ** self.order_of_growth
        return (finest + (self.size - finest) * growth).astype(np.float64)


def uniform(length: float, size: float, even: bool = False) -> FloatArray:
    """Return equally spaced positions from 0 to `length`, no farther apart than `size`.

    Args:
        length: last position [m].
        size: largest distance [m].
        even: an even number of intervals, so that the pattern of triangles mirrors itself.
    """
    step = 2 if even else 1
    intervals = step * max(1, math.ceil(length / (step * size) * (1 - 1e-10)))
    return np.linspace(0.0, length, intervals + 1, dtype=np.float64)


def graded(length: float, sizing: Sizing, extent: float | None = None) -> FloatArray:
    """Return positions from 0 (the interface) to `length` that follow the sizing.

    Args:
        length: last position [m].
        sizing: wanted sizes.
        extent: of a body that goes on beyond the length [m]; None: the length.
    """
    if sizing.interface_size is None:
        return uniform(length, sizing.size)
    fine = np.linspace(0.0, length, 4001, dtype=np.float64)
    density = 1.0 / sizing.at(fine, length if extent is None else extent)
    count = np.concatenate(([0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))))
    intervals = max(1, math.ceil(count[-1] * (1 - 1e-6)))
    positions = np.interp(np.linspace(0.0, count[-1], intervals + 1), count, fine)
    positions[-1] = length
    return positions


def graded_through(places: FloatArray, sizing: Sizing) -> FloatArray:
    """Return positions through all places, refined at each, with an even number in between.

    So every corner that places make has the same pattern of triangles, without one that has all its
    nodes on the interface.

    Args:
        places: ascending [m].
        sizing: wanted sizes over the distance from the nearest place.
    """
    positions = [places[:1]]
    for start, end in pairwise(places):
        half = graded(0.5 * (end - start), sizing)
        positions += [start + half[1:], end - half[-2::-1]]
    return np.concatenate(positions)


def between_walls(inside: FloatArray, wall: FloatArray) -> FloatArray:
    """Return positions in a body and, beyond both of its ends, in walls.

    Args:
        inside: ascending [m].
        wall: distances from the end of the body, from 0 on [m].
    """
    return np.concatenate([inside[0] - wall[:0:-1], inside, inside[-1] + wall[1:]])


def require_positive(**lengths: float) -> None:
    """Refuse lengths that are not positive, by name."""
    for name, value in lengths.items():
        if not value > 0:
            raise ValueError(f"{name} must be positive, got {value:g} m")
