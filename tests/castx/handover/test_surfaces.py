"""Surfaces of distorted bodies and of compensated moulds: closed, outward, and what remains."""

import numpy as np
import pytest
import pyvista

from castx.domain.source import gmsh_session
from castx.errors import CaseError
from castx.handover.surfaces import (
    compensated_mould,
    distorted,
    outer_triangles,
    write_mould_mesh,
    write_surface,
)
from tests.castx.handover.made_results import box, made

pytestmark = pytest.mark.serial
SHRINKAGE = 25.5e-6 * 537.0


def shrunk(folder, points, cells, **about):
    """Return a body that has contracted freely towards the origin."""
    return made(folder, "3d", points, cells, {"displacement": -SHRINKAGE * points}, **about)


@pytest.mark.parametrize("corners", [4, 8])
def test_the_surface_is_closed_and_outward_and_in_millimetres(tmp_path, corners):
    points, cells = box(corners)
    triangles = outer_triangles(points, cells[:, [0, 2, 1, 3]] if corners == 4 else cells)
    a, b, c = points[triangles].transpose(1, 0, 2)
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(0.03 * 0.02 * 0.01, rel=1e-12)
    assert write_surface(tmp_path / "part.stl", points, cells)
    read = pyvista.read(tmp_path / "part.stl")
    assert read.is_manifold and read.volume == pytest.approx(30.0 * 20.0 * 10.0, rel=1e-6)
    np.testing.assert_allclose(read.bounds, [0, 30, 0, 20, 0, 10], atol=1e-5)


def test_other_files_and_plane_bodies_are_refused(tmp_path):
    points, cells = box(4)
    with pytest.raises(CaseError, match=r"written as \.stl"):
        write_surface(tmp_path / "part.obj", points, cells)
    with pytest.raises(CaseError, match="of bodies in space alone"):
        write_surface(tmp_path / "part.stl", *box(-4))


def test_the_distorted_body_is_where_it_has_moved(tmp_path):
    points, cells = box(4)
    state = shrunk(tmp_path / "out", points, cells)
    np.testing.assert_allclose(distorted(state), points * (1.0 - SHRINKAGE), rtol=1e-12)


def test_the_best_fit_takes_a_rigid_motion_out(tmp_path):
    points, cells = box(4)
    turn = np.array([[np.cos(0.2), -np.sin(0.2), 0.0], [np.sin(0.2), np.cos(0.2), 0.0], [0, 0, 1]])
    moved = points @ turn.T + [0.01, -0.02, 0.03]
    state = made(tmp_path / "out", "3d", points, cells, {"displacement": moved - points})
    np.testing.assert_allclose(distorted(state, fit=True), points, atol=1e-12)


def test_the_best_fit_keeps_planes_of_symmetry(tmp_path):
    points, cells = box(4)
    planes = [{"normal": axis, "offset": 0.0} for axis in np.eye(3).tolist()]
    state = shrunk(tmp_path / "out", points, cells, symmetry=planes)
    np.testing.assert_allclose(distorted(state, True), points * (1.0 - SHRINKAGE), atol=1e-12)


def test_two_compensations_leave_the_square_and_the_cube_of_the_shrinkage(tmp_path):
    points, cells = box(4)
    mould, first = points, None
    left = []
    for run in range(3):
        state = shrunk(tmp_path / f"run{run}", mould, cells)
        first = first or state
        left.append((distorted(state) / np.where(points, points, 1.0))[points[:, 0] > 0.02, 0] - 1)
        mould = compensated_mould(state, None if run == 0 else first)
    assert left[0] == pytest.approx(-SHRINKAGE, abs=1e-6)
    assert left[1] == pytest.approx(-1.87512e-4, rel=1e-5)
    assert left[2] == pytest.approx(-2.56769e-6, rel=1e-5)


def test_other_cells_are_refused(tmp_path):
    state = shrunk(tmp_path / "a", *box(4))
    other = shrunk(tmp_path / "b", *box(4, (2, 2, 1)))
    with pytest.raises(CaseError, match="do not have the same cells"):
        compensated_mould(state, other)


def test_a_mesh_is_moved_with_its_names(tmp_path):
    import gmsh

    with gmsh_session():
        gmsh.model.occ.addBox(0, 0, 0, 0.03, 0.02, 0.01)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="casting")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.01)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "part.msh"))
        tags, places, _ = gmsh.model.mesh.getNodes()
        places = places.reshape(-1, 3)[np.argsort(tags)]
        _, corners = gmsh.model.mesh.getElementsByType(4)
    cells = np.searchsorted(np.sort(tags), corners).reshape(-1, 4)
    state = shrunk(tmp_path / "out", places, cells)
    write_mould_mesh(tmp_path / "next.msh", state, compensated_mould(state), tmp_path / "part.msh")
    with gmsh_session():
        gmsh.merge(str(tmp_path / "next.msh"))
        tags, found, _ = gmsh.model.mesh.getNodes()
        assert gmsh.model.getPhysicalName(3, 1) == "casting"
    found = found.reshape(-1, 3)[np.argsort(tags)]
    np.testing.assert_allclose(found, places * (1.0 + SHRINKAGE), atol=1e-12)
    beside = shrunk(tmp_path / "beside", places + np.array([5e-7 * 0.03, 0.0, 0.0]), cells)
    write_mould_mesh(tmp_path / "next.msh", beside, places, tmp_path / "part.msh")
    for apart in (2e-6 * 0.03, 0.1):
        elsewhere = shrunk(tmp_path / f"other {apart}", places + np.array([apart, 0.0, 0.0]), cells)
        with pytest.raises(CaseError, match="is not the mesh of"):
            write_mould_mesh(tmp_path / "next.msh", elsewhere, places, tmp_path / "part.msh")
