"""gmsh follows the least of all sizes over space."""

from __future__ import annotations

from dataclasses import replace

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.background import mapped_cells
from castx.meshes.cad.cells import TETRAHEDRON, node_points
from castx.meshes.cad.curvature import FILLING
from castx.meshes.cad.description import CadFile, CadPart, SizeMap
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.meshing import generate

pytestmark = pytest.mark.serial

SIDE = 0.02
PART = CadPart((CadFile("a.step"),), 0.008, across=0, curvature=4.0)


def edges(part: CadPart, folder) -> tuple[np.ndarray, np.ndarray]:
    """Return middles [m] and mean edges [m] of the cells of a cube."""
    with gmsh_session():
        gmsh.model.occ.addBox(0, 0, 0, *[1e3 * SIDE] * 3)
        gmsh.model.occ.synchronize()
        volumes = {tag: "a" for _, tag in gmsh.model.getEntities(3)}
        generate(part, volumes, faces_of(volumes), {}, str(folder / "grid"))
        nodes = gmsh.model.mesh.getElementsByType(TETRAHEDRON)[1].astype(np.int64)
        corners = node_points()[nodes.reshape(-1, 4)]
    lengths = [
        np.linalg.norm(corners[:, a] - corners[:, b], axis=1)
        for a in range(4) for b in range(a)
    ]  # fmt: skip
    return corners.mean(axis=1), np.mean(lengths, axis=0)


@pytest.fixture
def size_map():
    """Return sizes from 2 mm at x = 0 to 8 mm at the other side."""
    ends = np.array([0.0, SIDE])
    points = np.array([[x, y, z] for x in ends for y in ends for z in ends])
    cells = np.array([[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7],
                      [0, 4, 5, 7], [0, 4, 6, 7]])  # fmt: skip
    sizes = np.where(points[:, 0] > 0.0, 0.008, 0.002)
    return SizeMap(points[cells], sizes[cells])


def halved(size_map: SizeMap) -> SizeMap:
    return replace(size_map, sizes=0.5 * size_map.sizes)


def test_cells_follow_a_size_map(tmp_path, size_map):
    _, plain = edges(PART, tmp_path)
    middles, found = edges(replace(PART, size_map=size_map), tmp_path)
    near = middles[:, 0] < 0.15 * SIDE
    assert 0.002 < found[near].mean() < 0.0032
    assert found[middles[:, 0] > 0.8 * SIDE].mean() > 0.005
    assert len(found) > 4 * len(plain)


def test_the_least_of_all_sizes_holds(tmp_path, size_map):
    mapped = replace(PART, size_map=size_map)
    middles, found = edges(replace(mapped, size=0.004), tmp_path)
    assert found[middles[:, 0] > 0.8 * SIDE].mean() < 0.005
    assert found[middles[:, 0] < 0.15 * SIDE].mean() < 0.0032
    finer = edges(replace(mapped, size_map=halved(size_map)), tmp_path)[1]
    assert len(finer) > 4 * len(edges(mapped, tmp_path)[1])


def test_cells_are_estimated_with_the_largest_size(size_map):
    even = replace(size_map, sizes=np.full_like(size_map.sizes, 0.002))
    assert mapped_cells(even, 1.0) == pytest.approx(SIDE**3 / (FILLING * 0.002**3))
    assert mapped_cells(even, 0.001) == pytest.approx(8.0 * mapped_cells(even, 1.0))


def test_sizes_that_need_too_many_cells_are_refused(tmp_path, size_map):
    part = replace(PART, size_map=halved(size_map), most_cells=1e3)
    with pytest.raises(ValueError, match=r"geometry\.size_map asks for about .* cells"):
        edges(part, tmp_path)
