"""Element of the edge bubbles 4 λ_a λ_b, which make linear displacements quadratic.

With the linear functions λ of the vertices they span the quadratic polynomials of a simplex. The
number at an edge is what its mid-side has beyond the mean of its ends: linear motions have none.

Source: O. C. Zienkiewicz, R. L. Taylor and J. Z. Zhu, The Finite Element Method (2005), section
4.13, hierarchical elements.
"""

from __future__ import annotations

from typing import Any

import basix
import basix.ufl
import numpy as np


def bubble_element(cell: str, dimension: int) -> Any:
    """Return the vector-valued element of the edge bubbles of a simplex.

    Args:
        cell: "triangle" or "tetrahedron".
        dimension: number of components.
    """
    kind = getattr(basix.CellType, cell)
    quadratic = basix.create_element(basix.ElementFamily.P, kind, 2)
    entities = basix.topology(kind)
    corners, tdim = len(entities[0]), len(entities) - 1
    span = np.ascontiguousarray(np.asarray(quadratic.coefficient_matrix)[corners:])
    middles = np.asarray(quadratic.points)[corners:]
    points: list[list[Any]] = [[] for _ in range(4)]
    weights: list[list[Any]] = [[] for _ in range(4)]
    for of_dimension, there in enumerate(entities):
        for number in range(len(there)):
            mine = middles[number : number + 1] if of_dimension == 1 else np.zeros((0, tdim))
            points[of_dimension].append(mine)
            weights[of_dimension].append(np.ones((len(mine), 1, len(mine), 1)))
    element = basix.ufl.custom_element(
        kind, (), span, points, weights, 0, basix.MapType.identity, basix.SobolevSpace.H1,
        False, -1, 2,
    )  # fmt: skip
    return basix.ufl.blocked_element(element, shape=(dimension,))
