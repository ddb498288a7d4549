"""Volumes, areas and qualities of cells against shapes whose numbers are known."""

from __future__ import annotations

import math

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.cells import (
    Quality,
    cell_qualities,
    cell_volumes,
    face_areas,
    node_points,
    quality_of,
)

pytestmark = pytest.mark.serial

REGULAR = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])


def test_two_cells_of_which_one_is_regular():
    """A regular cell of edge 2√2 mm, and one over its first face with the apex close to it."""
    apex = REGULAR[:3].mean(axis=0) * 1.06
    with gmsh_session():
        gmsh.model.addDiscreteEntity(3, 1)
        gmsh.model.addDiscreteEntity(2, 1)
        gmsh.model.mesh.addNodes(3, 1, range(1, 6), np.vstack([REGULAR, apex]).ravel())
        gmsh.model.mesh.addElementsByType(1, 4, [1, 2], [1, 2, 3, 4, 1, 3, 2, 5])
        gmsh.model.mesh.addElementsByType(1, 2, [3], [1, 2, 3])
        points = node_points()
        volumes, areas = cell_volumes(points, 1), face_areas(points, 1)
        corners, qualities = cell_qualities([1])
    edge = 2e-3 * math.sqrt(2)
    assert volumes[0] == pytest.approx(edge**3 / (6 * math.sqrt(2)), rel=1e-12)
    assert areas == pytest.approx([math.sqrt(3) / 4 * edge**2], rel=1e-12)
    assert qualities[0] == pytest.approx(1.0) and 0.0 < qualities[1] < 0.1
    quality = quality_of(corners, qualities)
    assert (quality.cells, quality.poor, quality.worst) == (2, 1, qualities[1])
    assert quality.longest == pytest.approx(edge)
    assert quality.shortest == pytest.approx(np.linalg.norm(apex - REGULAR[0]) * 1e-3)
    assert quality.place == pytest.approx((REGULAR[:3].sum(axis=0) + apex) / 4e3)
    data = {"cells": 1, "mean": 1.0, "worst": 1.0, "place": [0, 1, 2], "poor": 0}
    assert Quality.of_data({**data, "shortest": 1.0, "longest": 1.0}).place == (0, 1, 2)
