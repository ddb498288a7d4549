"""Volumes, areas and extents of bodies against those of their geometry."""

from math import pi

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.domain.measures import (
    SurfaceMeasures,
    bounding_box,
    cell_means,
    cell_measure,
    extent,
    facet_areas,
    nodal_area_vectors,
    nodal_areas,
    nodal_mean,
    nodal_sum,
    nodal_volumes,
)
from castx.errors import MeshError
from tests.elastic_bodies import everywhere, generated

pytestmark = pytest.mark.sampled

R, H, WALL = 0.03, 0.04, 0.01
VOLUME = {"axisymmetric": pi * R**2 * H, "plane-strain": R * H, "3d": R * H * 0.02}
MANTLE = {"axisymmetric": 2 * pi * R * H, "plane-strain": H, "3d": H * 0.02}
models = pytest.mark.parametrize("model", VOLUME)
both = pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])


def casting(comm, model, cells="simplices"):
    """Return a body 0 ≤ x ≤ R, 0 ≤ y ≤ H, which is a cylinder when axisymmetric."""
    if model == "axisymmetric":
        mesh = generated(
            comm, model, "cylinder_in_mould", ["casting", "mould"], radius=R, height=H, wall=WALL,
            size=0.008, cells=cells,
        )  # fmt: skip
        return mesh.bodies["casting"], "mould"
    depth = {"depth": 0.02} if model == "3d" else {}
    mesh = generated(
        comm, model, "slab", ["casting"], length=R, width=H, size=0.008, cells=cells, **depth
    )
    return mesh.bodies["casting"], "far"


@models
def test_areas_of_facets_are_those_of_the_surface_they_make(model, comm):
    body, side = casting(comm, model)
    areas, vectors = facet_areas(body, model, body.facet_tags.find(body.surface_tag(side)))
    np.testing.assert_allclose(areas, nodal_areas(body, model, side), rtol=1e-12, atol=1e-20)
    expected = nodal_area_vectors(body, model, side)
    np.testing.assert_allclose(vectors, expected, rtol=1e-12, atol=1e-18)
    owned = body.node_numbering.owned
    total = comm.allreduce(float(areas[:owned].sum()))
    assert total == pytest.approx(MANTLE[model], rel=1e-9)
    nothing, _ = facet_areas(body, model, np.zeros(0, dtype=np.int32))
    assert not nothing.any()


@models
@both
def test_measures_of_cells_and_surfaces(model, cells, comm):
    body, side = casting(comm, model, cells)
    volume = fem.assemble_scalar(fem.form(1.0 * cell_measure(body, model, 2)))
    assert comm.allreduce(volume) == pytest.approx(VOLUME[model], rel=1e-12)
    for degree in (2, None):
        ds = SurfaceMeasures(body, model, [side])(side, degree)
        area = fem.assemble_scalar(fem.form(1.0 * ds))
        assert comm.allreduce(area) == pytest.approx(MANTLE[model], rel=1e-12)


@models
def test_forms_of_one_or_two_surfaces_are_the_same_on_all_sides(model, comm):
    """So that they are compiled once, whatever tags a mesh gives its surfaces."""
    body, side = casting(comm, model)
    names = [side, *(name for name in sorted(body.surfaces) if name != side)][:3]
    assert len({body.surface_tag(name) for name in names}) == 3
    a, b, c = names
    for together in ([(a,), (b,), (c,)], [(a, b), (c, a), (b, b, c)]):
        signatures = set()
        for asked in together:
            measures = SurfaceMeasures(body, model, asked)
            for name in asked:
                area = comm.allreduce(fem.assemble_scalar(fem.form(1.0 * measures(name, 2))))
                areas = nodal_areas(body, model, name)[: body.node_numbering.owned]
                assert area == pytest.approx(comm.allreduce(areas.sum()), rel=1e-12)
            signatures.add(sum(1.0 * measures(name, 2) for name in sorted(set(asked))).signature())
        assert len(signatures) == 1


@pytest.mark.ranks
@models
@both
def test_volumes_of_the_nodes_add_up(model, cells, comm):
    body, _ = casting(comm, model, cells)
    volumes = nodal_volumes(body, model)
    assert len(volumes) == body.nodes.dofmap.index_map.size_local and (volumes > 0).all()
    assert comm.allreduce(volumes.sum()) == pytest.approx(VOLUME[model], rel=1e-12)
    # Linear functions are integrated exactly: the centre lies at H/2.
    moment = comm.allreduce((volumes * body.points[: len(volumes), 1]).sum())
    assert moment == pytest.approx(VOLUME[model] * H / 2, rel=1e-12)


@models
@both
@pytest.mark.parametrize("degree", [2, None])
def test_areas_and_area_vectors_of_the_nodes(model, cells, degree, comm):
    body, side = casting(comm, model, cells)
    owned = body.nodes.dofmap.index_map.size_local
    areas = nodal_areas(body, model, side, degree)
    vectors = nodal_area_vectors(body, model, side, degree)
    assert vectors.shape == (len(body.points), body.mesh.geometry.dim)
    assert comm.allreduce(areas[:owned].sum()) == pytest.approx(MANTLE[model], rel=1e-12)
    elsewhere = np.abs(body.points[:, 0] - R) > 1e-9
    assert np.abs(areas[elsewhere]).max(initial=0.0) < 1e-18
    # The side is plane or a cylinder whose normal is x: vectors are areas along x, ghosts too.
    np.testing.assert_allclose(vectors[:, 0], areas, atol=1e-12 * MANTLE[model])
    np.testing.assert_allclose(vectors[:, 1:], 0.0, atol=1e-12 * MANTLE[model])


@pytest.mark.ranks
def test_ghosts_have_the_areas_of_their_owners(comm):
    body, side = casting(comm, "plane-strain")
    index_map, areas = body.nodes.dofmap.index_map, nodal_areas(body, "plane-strain", side)
    owned = comm.allgather(areas[: index_map.size_local])
    everywhere = index_map.local_to_global(np.arange(len(areas), dtype=np.int32))
    np.testing.assert_array_equal(areas, np.concatenate(owned)[everywhere])
    assert areas.max(initial=0.0) > 0 or comm.size > 1


def test_unknown_surfaces_are_refused(comm):
    body, _ = casting(comm, "plane-strain")
    for measured in (nodal_areas, nodal_area_vectors):
        with pytest.raises(MeshError, match="body 'casting' has no surface 'side'"):
            measured(body, "plane-strain", "side")


@pytest.mark.ranks
def test_a_nodal_sum_counts_every_rank_that_has_the_node(comm):
    body, _ = casting(comm, "plane-strain")
    sums = nodal_sum(body, np.ones(len(body.points)))
    numbers = comm.allgather(body.original_nodes)
    counts = np.bincount(np.concatenate(numbers))
    np.testing.assert_array_equal(sums, counts[body.original_nodes])


@pytest.mark.ranks
@both
def test_nodal_means_are_those_of_the_cells_of_all_ranks(cells, comm):
    body, _ = casting(comm, "plane-strain", cells)
    nodes, points = body.nodes.dofmap.list, body.points
    values = np.sin(200 * points[nodes].mean(axis=1) @ [2.0, -3.0])
    owned = body.mesh.topology.index_map(2).size_local
    corners = everywhere(comm, points[nodes[:owned]])
    of_all = everywhere(comm, values[:owned])
    around = (np.abs(corners - points[:, None, None]).max(axis=3) < 1e-9).any(axis=2)
    expected = around @ of_all / around.sum(axis=1)
    np.testing.assert_allclose(nodal_mean(body, values), expected, rtol=1e-12, atol=1e-14)


@pytest.mark.ranks
def test_boxes_enclose_the_points_of_all_ranks(comm):
    points = np.array([[comm.rank, -2.0 * comm.rank]])
    if comm.rank == 1:
        points = np.empty((0, 2))
    low, high = bounding_box(points, comm)
    others = [rank for rank in range(comm.size) if rank != 1]
    np.testing.assert_array_equal(low, [0.0, -2.0 * others[-1]])
    np.testing.assert_array_equal(high, [others[-1], 0.0])


@models
def test_the_extent_is_the_longest_edge(model, comm):
    body, _ = casting(comm, model)
    assert extent(body.mesh) == pytest.approx(max(R, H))


@models
def test_means_over_cells_add_up_to_what_the_nodes_have(model, comm):
    body, _ = casting(comm, model)
    values = 1.0 + 40.0 * body.points[:, 0] + np.sin(300.0 * body.points[:, 1])
    cells = fem.functionspace(body.mesh, ("DG", 0))
    volumes = fem.assemble_vector(fem.form(ufl.TestFunction(cells) * cell_measure(body, model, 1)))
    owned = int(cells.dofmap.index_map.size_local)
    found = volumes.array[:owned] @ cell_means(body, model, values)[:owned]
    nodal = nodal_volumes(body, model)
    assert comm.allreduce(found) == pytest.approx(comm.allreduce(nodal @ values[: len(nodal)]))
    even = cell_means(body, model, np.full(len(values), 0.3))
    np.testing.assert_allclose(even, 0.3, rtol=1e-12)
