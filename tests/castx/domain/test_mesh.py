"""Bodies of distributed meshes: sizes, names, node sets and their consistency on every rank."""

from math import pi

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import GENERATORS, Geometry
from castx.domain import compat
from castx.domain.cell_kinds import KINDS
from castx.domain.mesh import build_mesh
from castx.domain.source import write_mesh
from castx.domain.summary import mesh_summary
from castx.errors import MeshError
from tests.partitions import PARTITION, thinly_scattered

pytestmark = pytest.mark.sampled

CYLINDER = {"generator": "cylinder_in_mould", "radius": 0.03, "height": 0.1, "wall": 0.025}
BAR = {"length": 0.1, "width": 0.02, "size": 0.005}
RING = {"generator": "core_in_ring", "core_radius": 0.03, "core_bore": 0.01, "outer_radius": 0.06}
R, H, W, F = 0.03, 0.1, 0.025, 0.02
OUT = R + W
CASTING_AND_MOULD = ("casting", "mould")

SIZES = {
    "slab plane": (
        {"generator": "slab", "model": "plane-stress", **BAR},
        {"casting": 0.1 * 0.02},
        {"casting": {"wall": 0.02, "far": 0.02, "bottom": 0.1, "top": 0.1}},
    ),
    "slab 3d": (
        {"generator": "slab", "model": "3d", "depth": 0.01, **BAR},
        {"casting": 2e-5},
        {
            "casting": {"wall": 2e-4, "far": 2e-4, "bottom": 1e-3, "top": 1e-3}
            | {"front": 2e-3, "back": 2e-3}
        },
    ),
    "two slabs": (
        {"generator": "two_slabs", "model": "plane-strain", "mould_length": 0.05, **BAR},
        {"casting": 2e-3, "mould": 1e-3},
        {
            "casting": {"far": 0.02, "bottom": 0.1, "top": 0.1, "mould": 0.02},
            "mould": {"far": 0.02, "bottom": 0.05, "top": 0.05, "casting": 0.02},
        },
    ),
    "cylinder axisymmetric": (
        CYLINDER | {"model": "axisymmetric", "size": 0.005},
        {"casting": pi * R**2 * H, "mould": pi * (OUT**2 - R**2) * H},
        {
            "casting": {"top": pi * R**2, "base": pi * R**2, "mould": 2 * pi * R * H},
            "mould": {"top": pi * (OUT**2 - R**2), "base": pi * (OUT**2 - R**2)}
            | {"outside": 2 * pi * OUT * H, "casting": 2 * pi * R * H},
        },
    ),
    "cylinder with floor": (
        CYLINDER | {"model": "axisymmetric", "size": 0.005, "floor": F, "interface_size": 0.002},
        {"casting": pi * R**2 * H, "mould": pi * (OUT**2 * (H + F) - R**2 * H)},
        {
            "casting": {"top": pi * R**2, "mould": 2 * pi * R * H + pi * R**2},
            "mould": {"top": pi * (OUT**2 - R**2), "base": pi * OUT**2}
            | {"outside": 2 * pi * OUT * (H + F), "casting": 2 * pi * R * H + pi * R**2},
        },
    ),
    "quarter cylinder": (
        CYLINDER | {"model": "3d", "size": 0.01, "floor": F, "sector": "quarter"},
        {"casting": pi * R**2 * H / 4, "mould": pi * (OUT**2 * (H + F) - R**2 * H) / 4},
        {
            "casting": {"top": pi * R**2 / 4, "mould": (2 * pi * R * H + pi * R**2) / 4}
            | {"symmetry-x": R * H, "symmetry-y": R * H},
            "mould": {"top": pi * (OUT**2 - R**2) / 4, "base": pi * OUT**2 / 4}
            | {"outside": pi * OUT * (H + F) / 2, "casting": (2 * pi * R * H + pi * R**2) / 4}
            | {"symmetry-x": OUT * (H + F) - R * H, "symmetry-y": OUT * (H + F) - R * H},
        },
    ),
    "half cylinder": (
        CYLINDER | {"model": "3d", "size": 0.01, "sector": "half"},
        {"casting": pi * R**2 * H / 2, "mould": pi * (OUT**2 - R**2) * H / 2},
        {
            "casting": {"top": pi * R**2 / 2, "base": pi * R**2 / 2, "mould": pi * R * H}
            | {"symmetry-x": 2 * R * H},
            "mould": {"top": pi * (OUT**2 - R**2) / 2, "base": pi * (OUT**2 - R**2) / 2}
            | {"outside": pi * OUT * H, "casting": pi * R * H, "symmetry-x": 2 * W * H},
        },
    ),
    "blocks": (
        {"generator": "stacked_blocks", "model": "plane-strain", "size": 0.004}
        | {"upper": [0.03, 0.02], "base": [0.05, 0.01]},
        {"upper": 3e-4, "base": 2.5e-4},
        {
            "upper": {"top": 0.015, "side": 0.02, "symmetry-x": 0.02, "base": 0.015},
            "base": {"bottom": 0.025, "side": 0.01, "symmetry-x": 0.01, "shelf": 0.01}
            | {"upper": 0.015},
        },
    ),
    "blocks 3d": (
        {"generator": "stacked_blocks", "model": "3d", "size": 0.006, "symmetry": False}
        | {"upper": [0.03, 0.02, 0.02], "base": [0.03, 0.01, 0.04]},
        {"upper": 1.2e-5, "base": 1.2e-5},
        {
            "upper": {"top": 6e-4, "side": 2e-3, "base": 6e-4},
            "base": {"bottom": 1.2e-3, "side": 1.4e-3, "shelf": 6e-4, "upper": 6e-4},
        },
    ),
    "box": (
        {"generator": "box_in_mould", "model": "generalised-plane-strain", "size": 0.006}
        | {"box": [0.1, 0.06], "wall": 0.02, "interface_size": 0.002},
        {"casting": 6e-3, "mould": 0.14 * 0.08 - 6e-3},
        {
            "casting": {"top": 0.1, "mould": 0.22},
            "mould": {"top": 0.04, "outside": 0.16, "base": 0.14, "casting": 0.22},
        },
    ),
    "box with lid 3d": (
        {"generator": "box_in_mould", "model": "3d", "size": 0.01, "lid": True}
        | {"box": [0.06, 0.03, 0.04], "wall": 0.02},
        {"casting": 7.2e-5, "mould": 0.1 * 0.07 * 0.08 - 7.2e-5},
        {
            "casting": {"mould": 2 * (0.06 * 0.03 + 0.06 * 0.04 + 0.03 * 0.04)},
            "mould": {"top": 8e-3, "base": 8e-3, "outside": 0.36 * 0.07}
            | {"casting": 2 * (0.06 * 0.03 + 0.06 * 0.04 + 0.03 * 0.04)},
        },
    ),
    "ring axisymmetric": (
        RING | {"model": "axisymmetric", "size": 0.005, "height": 0.02},
        {"core": pi * (0.03**2 - 0.01**2) * 0.02, "casting": pi * (0.06**2 - 0.03**2) * 0.02},
        {
            "core": {
                "base": pi * 8e-4,
                "top": pi * 8e-4,
                "bore": pi * 4e-4,
                "casting": pi * 1.2e-3,
            },
            "casting": {"base": pi * 2.7e-3, "top": pi * 2.7e-3, "outside": pi * 2.4e-3}
            | {"core": pi * 1.2e-3},
        },
    ),
    "ring plane": (
        RING | {"model": "plane-stress", "size": 0.004},
        {"core": pi * 8e-4 / 4, "casting": pi * 2.7e-3 / 4},
        {
            "core": {"symmetry-x": 0.02, "symmetry-y": 0.02, "bore": pi * 0.005}
            | {"casting": pi * 0.015},
            "casting": {"symmetry-x": 0.03, "symmetry-y": 0.03, "outside": pi * 0.03}
            | {"core": pi * 0.015},
        },
    ),
    "ring 3d": (
        RING | {"model": "3d", "size": 0.01, "height": 0.02, "sector": "quarter", "core_bore": 0},
        {"core": pi * 9e-4 * 0.02 / 4, "casting": pi * 2.7e-3 * 0.02 / 4},
        {
            "core": {"base": pi * 9e-4 / 4, "top": pi * 9e-4 / 4, "casting": pi * 3e-4}
            | {"symmetry-x": 6e-4, "symmetry-y": 6e-4},
            "casting": {"base": pi * 2.7e-3 / 4, "top": pi * 2.7e-3 / 4, "outside": pi * 6e-4}
            | {"core": pi * 3e-4, "symmetry-x": 6e-4, "symmetry-y": 6e-4},
        },
    ),
}


def faceting(description):
    """Largest relative error of areas by straight edges on circles of the smallest radius."""
    if description["generator"] not in ("cylinder_in_mould", "core_in_ring"):
        return 1e-12
    if description["model"] == "axisymmetric":
        return 1e-12
    angle = 1.3 * description["size"] / (description.get("core_bore") or R)
    return angle**2 / 6


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("name", SIZES)
def test_bodies_and_surfaces_have_their_names_and_sizes(name, cells, comm):
    description, volumes, areas = SIZES[name]
    geometry = Geometry.model_validate(description | {"cells": cells})
    mesh = build_mesh(geometry, list(volumes), comm)
    assert all(body.kind.simplex == (cells == "simplices") for body in mesh.bodies.values())
    summary = mesh_summary(mesh)
    tolerance = faceting(description)
    assert [body.name for body in summary.bodies] == list(volumes)
    for body in summary.bodies:
        assert body.volume == pytest.approx(volumes[body.name], rel=tolerance)
        assert body.surfaces == pytest.approx(areas[body.name], rel=tolerance)
        assert body.unnamed == 0.0
        assert set(body.surfaces) <= set(geometry.surfaces[body.name]) | set(volumes)


def cylinder(comm, **arguments):
    description = CYLINDER | {"model": "3d", "size": 0.01, "sector": "quarter", "floor": F}
    return build_mesh(
        Geometry.model_validate(description | arguments), list(CASTING_AND_MOULD), comm
    )


@pytest.fixture(scope="module", params=["simplices", "quadrilaterals"])
def quarter(request):
    """A quarter cylinder in its mould, on all ranks."""
    return cylinder(MPI.COMM_WORLD, cells=request.param)


def cells_of(mesh):
    return "simplices" if mesh.bodies["mould"].kind.simplex else "quadrilaterals"


def test_surface_nodes_are_all_local_nodes_of_the_surface(quarter):
    for body, surface, holds in (
        ("mould", "outside", lambda x: np.abs(np.hypot(x[:, 0], x[:, 1]) - OUT) < 1e-9),
        ("mould", "base", lambda x: np.abs(x[:, 2] + F) < 1e-9),
        ("casting", "symmetry-x", lambda x: np.abs(x[:, 0]) < 1e-12),
        (
            "casting",
            "mould",
            lambda x: (np.abs(np.hypot(x[:, 0], x[:, 1]) - R) < 1e-9) | (np.abs(x[:, 2]) < 1e-9),
        ),
    ):
        points = quarter.bodies[body].points
        expected = np.flatnonzero(holds(points))
        assert np.array_equal(quarter.bodies[body].surface_nodes(surface), expected)


def test_nodes_lie_on_their_parents_vertices(quarter):
    parent = quarter.parent
    parent.topology.create_connectivity(0, 3)
    vertex_points = np.empty((len(parent.geometry.x), 3))
    vertex_points[parent.topology.connectivity(3, 0).array] = parent.geometry.x[
        compat.geometry_nodes(parent).ravel()
    ]
    for body in quarter.bodies.values():
        points = body.points
        assert np.abs(points - body.nodes.tabulate_dof_coordinates()).max(initial=0.0) < 1e-15
        assert len(body.parent_vertices) == len(points)
        assert np.abs(vertex_points[body.parent_vertices] - points).max(initial=0.0) < 1e-15


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", ["3d", "axisymmetric"])
def test_cells_are_positively_oriented(model, cells, comm):
    sector = {"sector": "quarter"} if model == "3d" else {}
    description = CYLINDER | {"model": model, "size": 0.01, "cells": cells} | sector
    mesh = build_mesh(Geometry.model_validate(description), list(CASTING_AND_MOULD), comm)
    for part in (mesh.parent, *(body.mesh for body in mesh.bodies.values())):
        gdim = part.geometry.dim
        assert gdim == part.topology.dim
        corners = part.geometry.x[compat.geometry_nodes(part)][:, :, :gdim]
        assert (KINDS[part.topology.cell_name()].corner_volumes(corners) > 0).all()


def test_the_same_mesh_is_made_every_time(quarter, comm):
    second = cylinder(comm, cells=cells_of(quarter))
    for body, other in zip(quarter.bodies.values(), second.bodies.values(), strict=True):
        assert np.array_equal(body.mesh.geometry.x, other.mesh.geometry.x)
        assert np.array_equal(body.facet_tags.indices, other.facet_tags.indices)
        assert np.array_equal(body.parent_vertices, other.parent_vertices)


@pytest.mark.ranks
def test_every_body_is_spread_over_the_ranks(quarter, comm):
    for body in quarter.bodies.values():
        cells = body.mesh.topology.index_map(3).size_local
        largest = comm.allreduce(cells, MPI.MAX)
        assert largest < 1.25 * comm.allreduce(cells) / comm.size


@pytest.mark.ranks
@pytest.mark.parametrize("cells, count, pairs", [("simplices", 4, 3), ("quadrilaterals", 1, 2)])
def test_a_rank_may_hold_nothing_of_a_body(cells, count, pairs, comm):
    description = {"generator": "two_slabs", "model": "plane-strain", "size": 1.0}
    description |= {"length": 1.0, "mould_length": 1.0, "width": 1.0, "cells": cells}
    mesh = build_mesh(Geometry.model_validate(description), list(CASTING_AND_MOULD), comm)
    summary = mesh_summary(mesh)
    assert [body.cells for body in summary.bodies] == [count, count]
    assert [body.volume for body in summary.bodies] == pytest.approx([1.0, 1.0])
    assert summary.interfaces[0].nodes == pairs


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_a_mesh_survives_its_file(cells, comm, shared_tmp_path):
    description = CYLINDER | {"model": "3d", "size": 0.01, "sector": "quarter", "floor": F}
    description |= {"cells": cells}
    geometry = Geometry.model_validate(description)
    file = shared_tmp_path / "part.msh"
    if comm.rank == 0:
        write_mesh(geometry, file)
    comm.Barrier()
    from_file = Geometry.model_validate({"file": str(file), "model": "3d"})
    written, read = (
        mesh_summary(build_mesh(g, list(CASTING_AND_MOULD), comm)) for g in (geometry, from_file)
    )
    for one, other in zip(written.bodies, read.bodies, strict=True):
        assert (one.name, one.cells, one.nodes) == (other.name, other.cells, other.nodes)
        assert one.volume == pytest.approx(other.volume, rel=1e-12)
        assert one.surfaces == pytest.approx(other.surfaces, rel=1e-12)
    assert [i.nodes for i in written.interfaces] == [i.nodes for i in read.interfaces]


@pytest.mark.ranks
def test_bodies_come_in_the_order_of_the_case(comm):
    geometry = Geometry.model_validate(CYLINDER | {"model": "axisymmetric", "size": 0.01})
    mesh = build_mesh(geometry, ["mould", "casting"], comm)
    assert list(mesh.bodies) == ["mould", "casting"]
    assert "outside" in mesh.bodies["mould"].surfaces


def test_unknown_surface_names_the_nearest(quarter):
    body = quarter.bodies["mould"]
    with pytest.raises(
        MeshError, match=r"body 'mould' has no surface 'outsid'; it has.*did you mean \"outside\""
    ):
        body.surface_nodes("outsid")


@pytest.mark.ranks
def test_a_generator_that_fails_is_reported_on_all_ranks(comm):
    geometry = Geometry.model_construct(
        generator="slab", model="3d", file=None, arguments={"length": 1.0, "width": 1.0, "size": 1}
    )
    with pytest.raises(MeshError, match='generator slab: the model "3d" needs a depth'):
        build_mesh(geometry, ["casting"], comm)


@pytest.mark.parametrize(
    "generator, arguments, text",
    [
        ("sphere", {}, f"no generator 'sphere'; known: {', '.join(GENERATORS)}"),
        (
            "slab",
            {"length": 1.0, "width": 1.0, "size": 1.0, "lenght": 1.0},
            "generator slab: .*'lenght'; its arguments: model, length, width",
        ),
        ("slab", {"length": 1.0}, "generator slab: missing a required argument: 'width'"),
    ],
)
def test_unknown_generators_and_arguments_are_named(generator, arguments, text, comm):
    geometry = Geometry.model_construct(
        generator=generator, model="plane-strain", file=None, arguments=arguments
    )
    with pytest.raises(MeshError, match=text):
        build_mesh(geometry, ["casting"], comm)


@pytest.mark.ranks
def test_nodes_of_a_surface_are_known_to_ranks_without_its_facets(comm, monkeypatch):
    """A rank may have a node at the floor, and no cell with a facet there."""
    monkeypatch.setattr(PARTITION, thinly_scattered)
    arguments = {"length": 0.04, "width": 0.02, "depth": 0.02, "size": 0.01}
    description = {"generator": "slab", "model": "3d", **arguments}
    body = build_mesh(Geometry.model_validate(description), ["casting"], comm).bodies["casting"]
    for name, axis, place in (("wall", 0, 0.0), ("far", 0, 0.04), ("bottom", 1, 0.0)):
        there = np.flatnonzero(np.abs(body.points[:, axis] - place) < 1e-9)
        np.testing.assert_array_equal(body.surface_nodes(name), there)
