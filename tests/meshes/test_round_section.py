"""Discs and their sectors: areas, mirror images, and the model of gmsh left as it was."""

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.grading import Sizing
from castx.meshes.linear_mesh import free_faces, handedness
from castx.meshes.round_section import disc

pytestmark = pytest.mark.serial

RADII = (0.2, 1.0, 1.5)
SIZING = Sizing(0.25)


def meshed(*arguments):
    with gmsh_session():
        return disc(*arguments)


def cell_set(mesh, sign=(1.0, 1.0)):
    points = np.round(mesh.points * sign, 9) + 0.0
    return {frozenset(map(tuple, points[cell])) for cell in mesh.cells}


@pytest.mark.parametrize("bore", [0.0, 0.2])
def test_triangles_fill_both_rings(bore):
    mesh = meshed((bore, 1.0, 1.5), SIZING)
    areas = 0.5 * handedness(mesh.points, mesh.cells)
    assert areas.min() > 0
    rings = np.pi / 4 * np.array([1.0 - bore**2, 1.5**2 - 1.0])
    assert np.bincount(mesh.regions, areas) == pytest.approx(rings, rel=0.02)
    radii = np.linalg.norm(mesh.points[mesh.cells], axis=2)
    assert radii[mesh.regions == 0].max() == pytest.approx(1.0)
    assert radii[mesh.regions == 1].min() > 0.98


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_sectors_are_mirror_images_of_the_quarter(cells):
    quarter, half, full = (meshed(RADII, SIZING, s, cells) for s in ("quarter", "half", "full"))
    assert cell_set(half) == cell_set(quarter) | cell_set(quarter, (1.0, -1.0))
    assert cell_set(full) == cell_set(half) | cell_set(half, (-1.0, 1.0))
    assert len(full.cells) == 4 * len(quarter.cells)
    # No seam is left open: only the bore and the outside have free edges.
    radii = np.linalg.norm(full.points[free_faces(full)], axis=2)
    assert (np.isclose(radii, 0.2) | np.isclose(radii, 1.5)).all()


def test_triangles_grow_away_from_the_interface():
    mesh = meshed(RADII, Sizing(0.25, 0.05))
    corners = mesh.points[mesh.cells]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    distance = np.abs(np.linalg.norm(corners.mean(axis=1), axis=1) - 1.0)
    assert longest[distance < 0.03].max() < 0.09
    assert np.median(longest[distance > 0.4]) > 0.15


def test_the_model_that_was_there_is_current_again():
    with gmsh_session():
        gmsh.model.add("outer")
        disc(RADII, SIZING)
        assert gmsh.model.getCurrent() == "outer"
        assert "quarter disc" not in gmsh.model.list()
        gmsh.model.remove()


def test_unknown_sectors_are_refused():
    with pytest.raises(ValueError, match="one of full, half, quarter; got 'third'"):
        meshed(RADII, SIZING, "third")
