"""Meshes of the generators as gmsh holds them, and what is measured on them."""

import basix
import numpy as np
import pytest

from castx.domain.gmsh_import import read_model
from castx.domain.source import gmsh_session

BOTH = pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])


def generated(generator, bodies, **arguments):
    """Return the mesh that a generator makes of bodies with these names."""
    with gmsh_session():
        generator(**arguments)
        return read_model(bodies, 3 if arguments["model"] == "3d" else 2, "test")


def refused(generator, text, **arguments):
    """Check that a generator refuses its arguments with a message that holds a pattern."""
    with gmsh_session(), pytest.raises(ValueError, match=text):
        generator(**{"size": 0.1, **arguments})


def edges(mesh):
    """Lengths of the edges of simplices, quadrilaterals and hexahedra, (edges, cells)."""
    corners = mesh.points[mesh.cells]
    pairs = basix.topology(basix.CellType[mesh.kind.name])[1]
    return np.stack([np.linalg.norm(corners[:, i] - corners[:, j], axis=1) for i, j in pairs])


def scaled_jacobians(mesh):
    """Smallest det(∂x/∂ξ) at the corners of quadrilaterals or hexahedra over that of a box."""
    corners = mesh.points[mesh.cells]
    size = np.ones(corners.shape[:2])
    for i, j in basix.topology(basix.CellType[mesh.kind.name])[1]:
        length = np.linalg.norm(corners[:, i] - corners[:, j], axis=1)
        size[:, i] *= length
        size[:, j] *= length
    return (mesh.kind.corner_volumes(corners) / size).min(axis=1)


def cell_set(mesh, sign=None):
    """Return the cells as a set of the positions of their corners, times a sign by axis."""
    points = mesh.points if sign is None else mesh.points * sign
    return {frozenset(map(tuple, np.round(points[cell], 9) + 0.0)) for cell in mesh.cells}
