"""Moduli of simple bodies: volume over surface, half of the thickness of a plate."""

from collections.abc import Sequence


def block_modulus(sides: Sequence[float]) -> float:
    """Return the modulus of a rectangle or a block [m].

    Args:
        sides: two or three [m].
    """
    return 0.5 / sum(1.0 / side for side in sides)


def ring_modulus(inner: float, outer: float, height: float | None) -> float:
    """Return the modulus of a ring or, with an inner radius of zero, of a cylinder [m].

    Args:
        inner: its inner radius [m].
        outer: its outer radius [m].
        height: along the axis [m]; None: of its section across the axis.
    """
    wall = outer - inner
    return 0.5 * wall if height is None else 0.5 / (1.0 / wall + 1.0 / height)


def prism_modulus(area: float, perimeter: float, depth: float | None) -> float:
    """Return the modulus of a prism [m].

    Args:
        area: of its section [m²].
        perimeter: of its section [m].
        depth: its length [m]; None: of the section.
    """
    if depth is None:
        return area / perimeter
    return area * depth / (perimeter * depth + 2.0 * area)
