"""Change of unknowns in which constraints fix single numbers: R and P on an independent path."""

from __future__ import annotations

from typing import NamedTuple

from petsc4py import PETSc

import gmsh
import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.kinematics.node_rows import owned_nodes
from castx.contact.kinematics.rows import InterfaceRows, Treatment
from castx.contact.kinematics.transform import ConstraintTransform
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.errors import CaseError
from castx.mechanics.fixed_directions import SurfaceDisplacement, fixed_directions
from castx.solvers.layout import Layout
from tests.contact_methods import EXACT
from tests.elastic_bodies import (
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    problem,
    sorted_by_place,
)

NAMES = ("casting", "mould")
FREE = {"casting": (), "mould": ()}


class Made(NamedTuple):
    """A change of unknowns with what it was made from."""

    mesh: CastingMesh
    layout: Layout
    fixed: list
    pairs: list
    transform: ConstraintTransform


def transformed(mesh, conditions, contacts, condensed=True, block_sizes=None) -> Made:
    names = list(mesh.bodies)
    dimension = 3 if mesh.model == "3d" else 2
    sizes = block_sizes or [dimension + 1 - b % 2 for b in range(len(names))]
    layout = Layout(
        mesh.comm, [mesh.bodies[n].nodes.dofmap.index_map for n in names], sizes
    )
    directions = [
        fixed_directions(mesh.bodies[n], mesh.model, conditions.get(n, ())) for n in names
    ]
    pairs = [node_pairs(mesh, *contact) for contact in contacts]
    treatment = Treatment.CONDENSED if condensed else Treatment.UNCHANGED
    rows = [InterfaceRows(p, treatment) for p in pairs]
    made = ConstraintTransform(layout, names, dimension, directions, rows)
    return Made(mesh, layout, directions, pairs, made)


def cup(comm, model="3d", sector="quarter"):
    arguments = {"sector": sector} if model == "3d" else {}
    return generated(
        comm, model, "cylinder_in_mould", NAMES,
        radius=0.03, height=0.04, wall=0.01, floor=0.01, size=0.01, **arguments,
    )  # fmt: skip


def corner(comm, folder):
    """A casting on a floor and against a wall that stands on the floor too."""

    def draw() -> None:
        geo = gmsh.model.geo
        places = [(-1, 0), (0, 0), (1, 0), (-1, 1), (0, 1), (1, 1), (-1, -1), (0, -1), (1, -1)]
        p = [geo.addPoint(x, y, 0, 0.3) for x, y in places]
        lines: dict[tuple[int, int], int] = {}

        def line(a, b):
            if (b, a) in lines:
                return -lines[b, a]
            lines[a, b] = geo.addLine(p[a], p[b])
            return lines[a, b]

        loops = {"casting": (1, 2, 5, 4), "wall": (0, 1, 4, 3), "floor": (6, 7, 8, 2, 1, 0)}
        surfaces = {
            name: geo.addPlaneSurface(
                [geo.addCurveLoop([line(a, b) for a, b in zip(c, (*c[1:], c[0]), strict=True)])]
            )
            for name, c in loops.items()
        }
        geo.synchronize()
        for name, tag in surfaces.items():
            gmsh.model.addPhysicalGroup(2, [tag], name=name)
        bottom = [lines[6, 7], lines[7, 8]]
        gmsh.model.addPhysicalGroup(1, bottom, name="bottom")
        gmsh.model.addPhysicalGroup(1, [lines[3, 0]], name="far")
        gmsh.model.addPhysicalGroup(1, [lines[5, 4]], name="top")
        gmsh.model.addPhysicalGroup(1, [lines[4, 3]], name="cap")
        gmsh.model.mesh.generate(2)

    return drawn(comm, "plane-strain", ["casting", "wall", "floor"], folder / "corner.msh", draw)


CORNER_CONTACTS = (("casting", "wall"), ("casting", "floor"), ("wall", "floor"))
UNIFORM = (SurfaceDisplacement("top", "normal", None),)


@pytest.fixture(params=["cup", "tilted ties", "corner", "axisymmetric"])
def made(request, comm, shared_tmp_path) -> Made:
    if request.param == "corner":
        held = {"floor": [fixed("bottom", "all")], "wall": [fixed("far", "x")], "casting": UNIFORM}
        return transformed(corner(comm, shared_tmp_path), held, CORNER_CONTACTS)
    mesh = cup(comm, "axisymmetric" if request.param == "axisymmetric" else "3d")
    held = {"mould": [fixed("base")], "casting": UNIFORM}
    if request.param == "tilted ties":
        held["mould"] = [fixed("base"), SurfaceDisplacement("outside", "normal", None)]
    return transformed(mesh, held, [NAMES])


def product_with_vector(matrix: PETSc.Mat, values: np.ndarray) -> np.ndarray:
    x, y = matrix.createVecs()
    x.array[:] = values
    matrix.mult(x, y)
    return y.array_r.copy()


def random_displacement(layout: Layout) -> np.ndarray:
    """Return owned values that depend on the global number only."""
    vector = layout.create_vector()
    first = vector.getOwnershipRange()[0]
    return np.sin(1.7 * (first + np.arange(layout.size_local)) ** 1.3)


def body_values(made: Made, b: int, values: np.ndarray) -> np.ndarray:
    """Return displacements at all nodes of a body by global number, (nodes, dimension)."""
    size = made.layout.block_sizes[b]
    dimension = 3 if made.mesh.model == "3d" else 2
    own = values[made.layout.local_slice(b)].reshape(-1, size)[:, :dimension]
    return everywhere(made.mesh.parent.comm, own)


def test_transformations_are_inverse(made):
    both = made.transform.R.matMult(made.transform.P)
    both.shift(-1.0)
    assert both.norm(PETSc.NormType.NORM_INFINITY) < 1e-12
    other = made.transform.P.matMult(made.transform.R)
    other.shift(-1.0)
    assert other.norm(PETSc.NormType.NORM_INFINITY) < 1e-12


@pytest.mark.ranks
def test_free_pairs_have_their_gap_as_coordinate(made, comm):
    u = random_displacement(made.layout)
    v = product_with_vector(made.transform.R, u)
    names = list(made.mesh.bodies)
    count = 0
    for interface in made.transform.interfaces:
        pairs, free = interface.pairs, interface.free
        secondary = body_values(made, names.index(pairs.secondary), u)[pairs.secondary_nodes]
        primary = body_values(made, names.index(pairs.primary), u)[pairs.primary_nodes]
        gap = np.sum(interface.normals * (secondary - primary), axis=1)
        np.testing.assert_allclose(v[interface.local[free]], gap[free], atol=1e-12)
        count += comm.allreduce(int(free.sum()))
    assert count > 4


def test_prescribed_entries_alone_decide_the_conditions(made, comm):
    v = random_displacement(made.layout)
    held = np.concatenate([p.local for p in made.transform.prescribed])
    assert len(np.unique(held)) == len(held)
    v[held] = 0.0
    u = product_with_vector(made.transform.P, v)
    for b, conditions in enumerate(made.fixed):
        size = made.layout.block_sizes[b]
        own = u[made.layout.local_slice(b)].reshape(-1, size)
        for condition in conditions:
            dimension = condition.directions.shape[1]
            moved = np.sum(own[condition.nodes, :dimension] * condition.directions, axis=1)
            moved = everywhere(comm, moved)
            assert len(moved) > 0
            np.testing.assert_allclose(
                moved, 0.0 if condition.value is not None else moved[0], atol=1e-13
            )


def test_pressures_are_untouched(made):
    u = random_displacement(made.layout)
    v = product_with_vector(made.transform.R, u)
    dimension = 3 if made.mesh.model == "3d" else 2
    for b, size in enumerate(made.layout.block_sizes):
        part = made.layout.local_slice(b)
        for k in range(dimension, size):
            np.testing.assert_array_equal(v[part][k::size], u[part][k::size])


@pytest.mark.ranks
def test_tied_nodes_move_equally_and_share_one_free_number(comm):
    mesh = cup(comm, "3d")
    made = transformed(mesh, {"casting": UNIFORM}, [])
    layout, tie = made.layout, made.transform.prescribed[-1]
    v = random_displacement(layout)
    for prescribed in made.transform.prescribed:
        v[prescribed.local] = 0.0
    u = product_with_vector(made.transform.P, v)
    nodes = mesh.bodies["casting"].surface_nodes("top")
    nodes = nodes[nodes < owned_nodes(layout, 0)]
    lifted = everywhere(comm, u[layout.local_slice(0)].reshape(-1, layout.block_sizes[0])[nodes, 2])
    assert len(lifted) > 3
    assert np.ptp(lifted) < 1e-14
    assert abs(lifted[0]) > 1e-3
    assert comm.allreduce(len(tie.local)) == len(lifted) - 1


def test_several_constraints_at_one_node(comm, shared_tmp_path):
    """The corner node of the casting has two gaps; the wall's under it hangs on the floor too."""
    mesh = corner(comm, shared_tmp_path)
    made = transformed(mesh, {}, CORNER_CONTACTS)
    by_interface = []
    for interface in made.transform.interfaces:
        here = np.linalg.norm(interface.pairs.points, axis=1) < 1e-9
        by_interface.append(everywhere(comm, interface.local[here]))
        assert np.all(interface.free)
    assert [len(local) for local in by_interface] == [1, 1, 1]
    assert by_interface[0][0] != by_interface[1][0]
    v = made.layout.create_vector()
    for interface in made.transform.interfaces:
        v.array[interface.local] = 1.0
    u = product_with_vector(made.transform.P, v.array_r)
    for interface in made.transform.interfaces:
        pairs = interface.pairs
        names = list(mesh.bodies)
        moved = body_values(made, names.index(pairs.secondary), u)[pairs.secondary_nodes]
        moved = moved - body_values(made, names.index(pairs.primary), u)[pairs.primary_nodes]
        np.testing.assert_allclose(np.sum(moved * pairs.normals, axis=1), 1.0, rtol=1e-12)


def test_a_pair_that_both_sides_hold_carries_no_constraint(comm, shared_tmp_path):
    mesh = corner(comm, shared_tmp_path)
    held = {"casting": [fixed("top", "x")], "wall": [fixed("cap", "x")]}
    made = transformed(mesh, held, CORNER_CONTACTS)
    wall = made.transform.interfaces[0]
    top = np.abs(wall.pairs.points[:, 1] - 1) < 1e-9
    assert comm.allreduce(int(top.sum())) == 1
    assert not np.any(wall.free[top])
    assert np.all(wall.free[~top])


@pytest.mark.parametrize("condensed", [True, False])
def test_refuses_a_pair_that_only_the_primary_could_open(comm, shared_tmp_path, condensed):
    mesh = corner(comm, shared_tmp_path)
    held = {"casting": [fixed("top", "x")], "wall": [fixed("far", "x")]}
    with pytest.raises(CaseError, match=r"'casting' hold its node at \(0, 1\) m .* with 'wall'"):
        transformed(mesh, held, CORNER_CONTACTS, condensed)
    transformed(mesh, held, [("wall", "casting"), *CORNER_CONTACTS[1:]], condensed)


def test_normals_lie_in_symmetry_planes_and_areas_are_projected(comm):
    mesh = cup(comm, "3d")
    made = transformed(mesh, {}, [NAMES])
    interface = made.transform.interfaces[0]
    vectors = interface.pairs.area_vectors
    for axis in range(2):
        there = np.abs(interface.pairs.points[:, axis]) < 1e-9
        assert np.abs(interface.normals[there, axis]).max(initial=0.0) < 1e-12
        others = np.delete(np.arange(3), axis)
        if axis == 0:
            there &= np.abs(interface.pairs.points[:, 1]) > 1e-9
        else:
            there &= np.abs(interface.pairs.points[:, 0]) > 1e-9
        np.testing.assert_allclose(
            interface.areas[there], np.linalg.norm(vectors[there][:, others], axis=1), rtol=1e-12
        )
    inside = np.all(interface.pairs.points[:, :2] > 1e-9, axis=1)
    np.testing.assert_allclose(interface.normals[inside], interface.pairs.normals[inside])
    np.testing.assert_allclose(np.linalg.norm(interface.normals, axis=1), 1.0, rtol=1e-12)


def test_other_supports_leave_the_normal(comm):
    mesh = cup(comm, "3d", sector="full")
    made = transformed(mesh, {"casting": [fixed("top")]}, [NAMES])
    interface = made.transform.interfaces[0]
    np.testing.assert_array_equal(interface.normals, interface.pairs.normals)


def test_refuses_a_uniform_surface_that_is_held(comm):
    held = {"casting": [fixed("top", "z"), *UNIFORM]}
    with pytest.raises(CaseError, match="casting/top normal is uniform, but another condition"):
        transformed(cup(comm), held, [])


def shrunk_on(comm, sector: str, method: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points, forces and areas of a hot core that a cup with a floor holds."""
    mesh = cup(comm, "3d", sector)
    hot = body(elastic(70e9, 0.33, 2e-5), loads=())
    made = problem(
        mesh, {"casting": hot, "mould": body(elastic(200e9, 0.3, 1e-5))},
        {"mould": [fixed("base")]}, [Contact(*NAMES, method)],
    )  # fmt: skip
    heat(made, lambda x: 20 + 100 * x[:, 2] / 0.04 + 3e3 * np.abs(x[:, 0]))
    made.equilibrium.solve(0.0)
    points = everywhere(comm, made.pairs[0].points)
    return points, everywhere(comm, made.pair_values()[1]), made.gaps.areas


@pytest.mark.parametrize("method", EXACT)
def test_quarter_model_has_the_pair_forces_of_the_full_one(comm, method):
    points, forces, _ = shrunk_on(comm, "full", method)
    quarter_points, quarter_forces, _ = shrunk_on(comm, "quarter", method)
    in_quarter = np.all(points[:, :2] > -1e-9, axis=1)
    share = np.prod(np.where(np.abs(points[:, :2]) < 1e-9, 0.5, 1.0), axis=1)
    expected = sorted_by_place(points[in_quarter], (forces * share)[in_quarter])
    found = sorted_by_place(quarter_points, quarter_forces)
    np.testing.assert_allclose(found[0], expected[0], atol=1e-12)
    largest = forces.max()
    assert 0 < np.count_nonzero(forces) < len(forces)
    np.testing.assert_allclose(found[1], expected[1], atol=1e-8 * largest)
