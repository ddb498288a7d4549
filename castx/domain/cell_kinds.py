"""Kinds of linear cells, in the numbering of DOLFINx."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import basix
import numpy as np

from castx.arrays import FloatArray, LongArray


@dataclass(frozen=True)
class CellKind:
    """A kind of linear cells.

    Args:
        name: of the kind in basix and DOLFINx.
        plural: for messages.
        dimension: of the cell.
        gmsh: gmsh's number of the kind.
        from_gmsh: gmsh's number of each corner.
        mirrored: corners in an order that makes a proper cell of a mirror image.
        face: name of the kind of its faces.
    """

    name: str
    plural: str
    dimension: int
    gmsh: int
    from_gmsh: tuple[int, ...]
    mirrored: tuple[int, ...]
    face: str

    @property
    def corners(self) -> int:
        """Number of corners."""
        return len(self.from_gmsh)

    @property
    def simplex(self) -> bool:
        """Whether it is a line, triangle or tetrahedron."""
        return self.corners == self.dimension + 1

    @cached_property
    def faces(self) -> LongArray:
        """Corners of each face, (faces, corners of a face)."""
        return np.array(basix.topology(basix.CellType[self.name])[self.dimension - 1])

    @cached_property
    def reference(self) -> FloatArray:
        """Corners of the reference cell, (corners, dimension)."""
        return np.array(basix.geometry(basix.CellType[self.name]), dtype=np.float64)

    def shape_functions(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the shape functions of the corners and their gradients in the reference cell.

        Args:
            points: in the reference cell, (points, dimension).

        Returns:
            Values (points, corners) and gradients (points, corners, dimension).
        """
        cell_type = basix.CellType[self.name]
        element = basix.create_element(basix.ElementFamily.P, cell_type, 1)
        table: Any = element.tabulate(1, points)
        return table[0, :, :, 0], np.moveaxis(table[1:, :, :, 0], 0, -1)

    def quadrature(self, degree: int) -> tuple[FloatArray, FloatArray]:
        """Return points (points, dimension) and weights (points,) exact for a degree."""
        rule: Any = basix.make_quadrature(basix.CellType[self.name], degree)
        return rule[0], rule[1]

    def jacobians(self, corners: FloatArray, points: FloatArray) -> FloatArray:
        """Return ∂x/∂ξ at points of the reference cell, (cells, points, gdim, dimension).

        Args:
            corners: (cells, corners, gdim) [m].
            points: in the reference cell, (points, dimension).
        """
        slopes = self.shape_functions(points)[1]
        return np.asarray(np.einsum("cai,pak->cpik", corners, slopes))

    def corner_volumes(self, corners: FloatArray) -> FloatArray:
        """Return det(∂x/∂ξ) at the corners of cells, at one point where it is constant.

        Args:
            corners: (cells, corners, dimension) [m].

        Returns:
            (cells, points) [m², m³].
        """
        points = self.reference[:1] if self.simplex else self.reference
        return np.asarray(np.linalg.det(self.jacobians(corners, points)))


LINE = CellKind("interval", "lines", 1, 1, (0, 1), (1, 0), "point")
TRIANGLE = CellKind("triangle", "triangles", 2, 2, (0, 1, 2), (0, 2, 1), "interval")
QUADRILATERAL = CellKind(
    "quadrilateral", "quadrilaterals", 2, 3, (0, 1, 3, 2), (1, 0, 3, 2), "interval"
)
TETRAHEDRON = CellKind("tetrahedron", "tetrahedra", 3, 4, (0, 1, 2, 3), (0, 1, 3, 2), "triangle")
HEXAHEDRON = CellKind(
    "hexahedron",
    "hexahedra",
    3,
    5,
    (0, 1, 3, 2, 4, 5, 7, 6),
    (1, 0, 3, 2, 5, 4, 7, 6),
    "quadrilateral",
)
KINDS = {kind.name: kind for kind in (LINE, TRIANGLE, QUADRILATERAL, TETRAHEDRON, HEXAHEDRON)}


def kinds_of_dimension(dimension: int) -> list[CellKind]:
    """Return the kinds of cells of a dimension."""
    return [kind for kind in KINDS.values() if kind.dimension == dimension]


def linear_means(places: FloatArray, values: FloatArray, model: str) -> FloatArray:
    """Return the means of linear fields over triangles or tetrahedra, shape (cells,).

    Args:
        places: of the corners [m], shape (cells, corners, gdim).
        values: at the corners, shape (cells, corners).
        model: geometric model, in an axisymmetric one outer corners count for more.
    """
    if model != "axisymmetric":
        return np.asarray(values.mean(axis=1))
    radii = places[:, :, 0]
    total = radii.sum(axis=1, keepdims=True)
    return np.asarray(((total + radii) / (4.0 * total) * values).sum(axis=1))
