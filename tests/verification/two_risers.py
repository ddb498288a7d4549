"""Mesh of two risers on a runner, which one melt fills."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from tests.verification.sections import Box, Corner, squares_of, write_section

GRID = 10e-3
AREAS = np.array([4 * GRID, GRID])
"""Of the risers, per metre [m²]."""
SURFACES = ("wall", "wide", "narrow")


def volume(narrow: int) -> float:
    """Return the volume of the section per metre [m³], with a narrow riser of so many 10 mm."""
    return len(squares_of(_boxes(narrow))) * GRID**2


def _boxes(narrow: int) -> tuple[Box, ...]:
    """Return a runner, a riser 50 mm high, and a narrow one."""
    return ((0, 7, 0, 2), (0, 4, 2, 5), (6, 7, 2, narrow))


def write(path: Path, narrow: int) -> None:
    """Write the section as triangles of 10 mm, with surfaces wide, narrow and wall.

    Args:
        path: of the file.
        narrow: height of the narrow riser in 10 mm.
    """
    write_section(path, _boxes(narrow), GRID, SURFACES, partial(_surface, narrow=narrow))


def _surface(a: Corner, b: Corner, narrow: int) -> str:
    if a[1] == b[1] == 5 and a[0] < 5:
        return "wide"
    return "narrow" if a[1] == b[1] == narrow else "wall"
