"""Node pairs: both sides at one place, areas, normals, and the same on any number of ranks."""

from functools import cache
from math import pi

from mpi4py import MPI

import gmsh
import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.source import gmsh_session
from castx.errors import MeshError
from tests.partitions import PARTITION, thinly_scattered

pytestmark = pytest.mark.sampled

R, H, W, F = 0.03, 0.1, 0.025, 0.02
CYLINDER = {"generator": "cylinder_in_mould", "radius": R, "height": H, "wall": W, "floor": F}
QUARTER = CYLINDER | {"model": "3d", "size": 0.009, "sector": "quarter"}
AXISYMMETRIC = CYLINDER | {"model": "axisymmetric", "size": 0.006, "interface_size": 0.003}
SLABS = {"generator": "two_slabs", "model": "plane-strain", "size": 0.003, "length": 0.02}
SLABS |= {"mould_length": 0.01, "width": 0.012}


BOX = {"generator": "box_in_mould", "model": "3d", "size": 0.01, "lid": True, "wall": 0.01}
BOX |= {"box": [0.03, 0.02, 0.04]}
SIMPLICIAL = {"quarter": QUARTER, "axisymmetric": AXISYMMETRIC, "slabs": SLABS, "box": BOX}
DESCRIPTIONS = SIMPLICIAL | {
    f"{name} quads": description | {"cells": "quadrilaterals"}
    for name, description in SIMPLICIAL.items()
}


def both(name):
    return pytest.mark.parametrize("name", [name, f"{name} quads"])


def casting_and_mould(description, comm):
    return build_mesh(Geometry.model_validate(description), ["casting", "mould"], comm)


@pytest.fixture(scope="module")
def interface():
    """Mesh and pairs of a description, made once."""

    @cache
    def build(name):
        mesh = casting_and_mould(DESCRIPTIONS[name], MPI.COMM_WORLD)
        return mesh, node_pairs(mesh, "casting", "mould")

    return build


def total(comm, values):
    return comm.allreduce(values.sum(axis=0))


def coordinates_by_number(body, comm):
    """Coordinates of all nodes of a body, by global number."""
    owned = body.nodes.dofmap.index_map.size_local
    return np.concatenate(comm.allgather(body.points[:owned]))


@pytest.mark.parametrize("name", DESCRIPTIONS)
def test_both_nodes_of_a_pair_are_at_its_point(name, interface, comm):
    mesh, pairs = interface(name)
    for body, nodes in (("casting", pairs.secondary_nodes), ("mould", pairs.primary_nodes)):
        points = coordinates_by_number(mesh.bodies[body], comm)[nodes]
        assert np.abs(points - pairs.points).max(initial=0.0) < 1e-15
    local = mesh.bodies["casting"].points[pairs.secondary_local]
    assert np.array_equal(local, pairs.points)


@pytest.mark.ranks
def test_pairs_are_found_where_a_rank_has_one_side_alone(comm, monkeypatch):
    """The owner of a vertex may have the node of one body, and has to hear of that of the other."""
    monkeypatch.setattr(PARTITION, thinly_scattered)
    mesh = casting_and_mould(DESCRIPTIONS["box"], comm)
    for names in (("casting", "mould"), ("mould", "casting")):
        pairs = node_pairs(mesh, *names)
        points = coordinates_by_number(mesh.bodies[names[1]], comm)
        assert (pairs.primary_nodes >= 0).all()
        np.testing.assert_allclose(points[pairs.primary_nodes], pairs.points, atol=1e-15)
        assert total(comm, pairs.areas) == pytest.approx(2 * (6e-4 + 1.2e-3 + 8e-4))


@pytest.mark.ranks
@pytest.mark.parametrize("name", DESCRIPTIONS)
def test_every_shared_node_is_paired_once_on_the_owner(name, interface, comm):
    mesh, pairs = interface(name)
    first, end = mesh.bodies["casting"].nodes.dofmap.index_map.local_range
    assert ((first <= pairs.secondary_nodes) & (pairs.secondary_nodes < end)).all()
    secondary = np.concatenate(comm.allgather(pairs.secondary_nodes))
    primary = np.concatenate(comm.allgather(pairs.primary_nodes))
    points = coordinates_by_number(mesh.bodies["casting"], comm)
    expected = {
        SLABS["generator"]: lambda x: x[:, 0] == 0.0,
        CYLINDER["generator"]: lambda x: (
            (np.abs(x[:, -1 if mesh.model == "3d" else 1]) < 1e-12)
            | (np.abs((np.hypot(x[:, 0], x[:, 1]) if mesh.model == "3d" else x[:, 0]) - R) < 1e-9)
        ),
        BOX["generator"]: lambda x: np.isclose(
            np.abs((x - [0, 0, 0.01]) / [0.015, 0.02, 0.01]).max(axis=1), 1.0
        ),
    }[DESCRIPTIONS[name]["generator"]]
    assert np.array_equal(np.sort(secondary), np.flatnonzero(expected(points)))
    assert len(np.unique(primary)) == len(primary)


@pytest.mark.ranks
@both("slabs")
def test_areas_and_normals_of_a_plane_interface(name, interface, comm):
    _, pairs = interface(name)
    assert np.allclose(pairs.normals, [1.0, 0.0], atol=1e-15)
    assert total(comm, pairs.areas) == pytest.approx(0.012)
    ends = (pairs.points[:, 1] == 0.0) | (pairs.points[:, 1] == 0.012)
    assert np.allclose(pairs.areas, np.where(ends, 0.0015, 0.003))


@pytest.mark.ranks
def test_exchanged_bodies_have_the_opposite_normal(interface):
    pairs = node_pairs(interface("slabs")[0], "mould", "casting")
    assert (pairs.secondary, pairs.primary) == ("mould", "casting")
    assert np.allclose(pairs.normals, [-1.0, 0.0], atol=1e-15)


@both("axisymmetric")
def test_axisymmetric_areas_are_those_of_the_full_turn(name, interface, comm):
    _, pairs = interface(name)
    assert total(comm, pairs.areas) == pytest.approx(2 * pi * R * H + pi * R**2, rel=1e-12)
    vector = total(comm, pairs.area_vectors)
    assert vector == pytest.approx([-2 * pi * R * H, pi * R**2], rel=1e-12)
    on_axis = pairs.points[:, 0] == 0.0
    assert comm.allreduce(np.count_nonzero(on_axis)) == 1
    assert np.allclose(pairs.normals[on_axis], [0.0, 1.0])
    assert (pairs.areas > 0).all()


@both("box")
def test_area_vectors_of_a_closed_surface_cancel_and_edges_belong_to_two_sides(
    name, interface, comm
):
    _, pairs = interface(name)
    assert total(comm, pairs.areas) == pytest.approx(2 * (6e-4 + 1.2e-3 + 8e-4))
    assert total(comm, pairs.area_vectors) == pytest.approx(np.zeros(3), abs=1e-17)
    outwards = pairs.points - [0, 0, 0.01]
    corner = (np.abs(outwards) > [0.0149, 0.0199, 0.0099]).all(axis=1)
    assert comm.allreduce(np.count_nonzero(corner)) == 8
    inwards = -np.sign(outwards[corner])
    assert (pairs.normals[corner] * inwards > 0.2).all()


@both("quarter")
def test_normals_of_the_mould_point_into_the_cylinder(name, interface, comm):
    _, pairs = interface(name)
    assert np.allclose(np.linalg.norm(pairs.normals, axis=1), 1.0)
    side = pairs.points[:, 2] > 1e-9
    side &= (pairs.points[:, 0] > 1e-9) & (pairs.points[:, 1] > 1e-9)
    radial = pairs.points[side, :2] / R
    assert ((-pairs.normals[side, :2] * radial).sum(axis=1) > 1 - 2e-3).all()
    floor = (np.abs(pairs.points[:, 2]) < 1e-9) & (np.hypot(*pairs.points[:, :2].T) < R - 1e-9)
    assert np.allclose(pairs.normals[floor], [0.0, 0.0, 1.0])
    # Area vectors of a surface add up to those of its flat shadows.
    shadow = total(comm, pairs.area_vectors)
    assert shadow[:2] == pytest.approx([-R * H, -R * H], rel=1e-12)
    assert shadow[2] == pytest.approx(pi * R**2 / 4, rel=0.02)


@pytest.mark.ranks
@pytest.mark.parametrize("name", DESCRIPTIONS)
def test_sums_do_not_depend_on_the_ranks(name, interface, comm):
    def moments(pairs, communicator):
        per_node = [np.ones(len(pairs.areas)), pairs.areas, pairs.areas**2]
        per_node += [*(pairs.areas[:, None] * pairs.points).T, *(pairs.normals * pairs.points).T]
        return total(communicator, np.column_stack(per_node))

    alone = casting_and_mould(DESCRIPTIONS[name], MPI.COMM_SELF)
    values = moments(interface(name)[1], comm)
    serial = moments(node_pairs(alone, "casting", "mould"), MPI.COMM_SELF)
    assert values == pytest.approx(serial, rel=1e-12, abs=1e-12)


@pytest.mark.ranks
@pytest.mark.parametrize("name", ["quarter", "axisymmetric", "quarter quads"])
def test_few_pairs_are_split_between_ranks(name, interface, comm):
    mesh, pairs = interface(name)
    first, end = mesh.bodies["mould"].nodes.dofmap.index_map.local_range
    split = np.count_nonzero((pairs.primary_nodes < first) | (pairs.primary_nodes >= end))
    assert comm.allreduce(split) <= 0.05 * comm.allreduce(len(pairs.areas))


def write_squares(file, corners):
    """Unit squares named a, b, ... at lower left corners, sharing the nodes that coincide."""
    with gmsh_session():
        geo = gmsh.model.occ
        squares = [geo.addRectangle(x, y, 0, 1, 1) for x, y in corners]
        geo.fragment([(2, s) for s in squares], [])
        geo.synchronize()
        for name, (_, square) in zip("abc", gmsh.model.getEntities(2), strict=False):
            gmsh.model.addPhysicalGroup(2, [square], name=name)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(file))


def squares(corners, comm, folder):
    file = folder / "squares.msh"
    if comm.rank == 0:
        write_squares(file, corners)
    comm.Barrier()
    geometry = Geometry.model_validate({"file": str(file), "model": "plane-strain"})
    return build_mesh(geometry, list("abc"[: len(corners)]), comm)


def test_bodies_that_touch_at_a_point_share_no_surface(comm, shared_tmp_path):
    mesh = squares([(0, 0), (1, 1)], comm, shared_tmp_path)
    with pytest.raises(MeshError, match="'a' and 'b' share no surface"):
        node_pairs(mesh, "a", "b")


def test_only_shared_facets_count_where_three_bodies_meet(comm, shared_tmp_path):
    mesh = squares([(0, 0), (1, 0), (1, 1)], comm, shared_tmp_path)
    assert total(comm, node_pairs(mesh, "a", "b").areas) == pytest.approx(1.0)
    upwards = node_pairs(mesh, "c", "b")
    assert total(comm, upwards.areas) == pytest.approx(1.0)
    assert np.allclose(upwards.normals, [0.0, 1.0], atol=1e-12)
    assert (np.abs(upwards.points[:, 1] - 1.0) < 1e-12).all()
    with pytest.raises(MeshError, match="'a' and 'c' share no surface"):
        node_pairs(mesh, "a", "c")


@pytest.mark.ranks
def test_a_body_without_thickness_between_its_sides_is_refused(comm, shared_tmp_path):
    file = shared_tmp_path / "slit.msh"
    if comm.rank == 0:
        write_slit(file)
    comm.Barrier()
    geometry = Geometry.model_validate({"file": str(file), "model": "plane-strain"})
    mesh = build_mesh(geometry, ["a", "b"], comm)
    with pytest.raises(MeshError, match=r"'a' is so thin at \(1, 0.*normals of its two sides"):
        node_pairs(mesh, "a", "b")


def write_slit(file):
    """Two triangles of a that meet at one node, with b above and below."""
    points = [(0, -1), (0, 1), (1, 0), (2, -1), (2, 1), (1, -2), (1, 2)]
    cells = {"a": [(0, 2, 1), (3, 4, 2)], "b": [(0, 3, 2), (1, 2, 4), (0, 5, 3), (1, 4, 6)]}
    with gmsh_session():
        for tag, (name, triangles) in enumerate(cells.items(), start=1):
            gmsh.model.addDiscreteEntity(2, tag)
            if tag == 1:
                flat = [float(v) for point in points for v in (*point, 0.0)]
                gmsh.model.mesh.addNodes(2, tag, range(1, len(points) + 1), flat)
            corners = [node + 1 for triangle in triangles for node in triangle]
            gmsh.model.mesh.addElementsByType(tag, 2, [], corners)
            gmsh.model.addPhysicalGroup(2, [tag], tag, name=name)
        gmsh.write(str(file))
