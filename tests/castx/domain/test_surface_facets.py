"""Facets of surfaces on all ranks: areas, normals and shares of their corners."""

import numpy as np
import pytest

from castx.domain.measures import nodal_area_vectors, nodal_areas
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.surface_facets import surface_facets
from castx.errors import MeshError
from tests.castx.domain.interface_meshes import MESHES, NAMES, cup
from tests.castx.fakes import cylinder_mesh

pytestmark = pytest.mark.sampled


@pytest.fixture(params=MESHES)
def mesh(request, comm):
    return MESHES[request.param](comm)


@pytest.mark.ranks
def test_facets_have_the_areas_of_assembled_forms(mesh):
    pairs = node_pairs(mesh, *NAMES)
    facets = surface_facets(mesh, mesh.bodies["casting"], "mould")
    count = mesh.bodies["casting"].nodes.dofmap.index_map.size_global
    areas = np.bincount(facets.nodes.ravel(), facets.areas.ravel(), count)
    np.testing.assert_allclose(areas[pairs.secondary_nodes], pairs.areas, rtol=1e-10)
    for k in range(pairs.points.shape[1]):
        vector = np.bincount(facets.nodes.ravel(), facets.vectors[:, :, k].ravel(), count)
        found = -vector[pairs.secondary_nodes]
        np.testing.assert_allclose(found, pairs.area_vectors[:, k], atol=1e-10 * areas.max())


def test_shares_of_the_corners_add_up_to_the_nodal_areas(mesh):
    for name, surface in ((NAMES[0], NAMES[1]), (NAMES[1], NAMES[0]), (NAMES[1], "outside")):
        body = mesh.bodies[name]
        facets = surface_facets(mesh, body, surface)
        count = body.nodes.dofmap.index_map.size_global
        nodes = facets.nodes.ravel()
        local = body.nodes.dofmap.index_map.local_to_global(body.surface_nodes(surface))
        areas = nodal_areas(body, mesh.model, surface)[body.surface_nodes(surface)]
        found = np.bincount(nodes, facets.areas.ravel(), count)[local]
        np.testing.assert_allclose(found, areas, rtol=1e-10)
        vectors = nodal_area_vectors(body, mesh.model, surface)[body.surface_nodes(surface)]
        for k in range(vectors.shape[1]):
            found = np.bincount(nodes, facets.vectors[:, :, k].ravel(), count)[local]
            np.testing.assert_allclose(found, vectors[:, k], atol=1e-10 * facets.areas.max())


def test_normals_are_unit_vectors_out_of_the_body(mesh):
    """Seen from the middle of a convex casting, its surface faces away."""
    facets = surface_facets(mesh, mesh.bodies["casting"], "mould")
    np.testing.assert_allclose(np.linalg.norm(facets.normals, axis=1), 1.0, rtol=1e-12)
    middles = facets.points.mean(axis=1)
    inside = np.average(middles, axis=0, weights=facets.areas.sum(axis=1))
    if mesh.model == "axisymmetric":
        inside[0] = 0.0
    assert (np.sum((middles - inside) * facets.normals, axis=1) > 0).all()
    back = surface_facets(mesh, mesh.bodies["mould"], "casting")
    order, other = (np.lexsort(np.round(f.points.mean(axis=1), 9).T) for f in (facets, back))
    np.testing.assert_allclose(facets.normals[order], -back.normals[other], atol=1e-12)


@pytest.mark.ranks
def test_normals_of_facets_along_an_axis_do_not_lean(comm):
    """By no rounding either: restarts go on with the same bits."""
    mesh = cylinder_mesh(comm, "axisymmetric", 3e-3)
    facets = surface_facets(mesh, mesh.bodies["casting"], "mould")
    for vectors in (facets.normals, facets.vectors.reshape(-1, 2)):
        assert (np.count_nonzero(vectors, axis=1) == 1).all()


@pytest.mark.ranks
def test_all_ranks_have_all_facets_once(mesh, comm):
    facets = surface_facets(mesh, mesh.bodies["casting"], "mould")
    assert facets.kind.corners == facets.nodes.shape[1]
    faces = np.sort(facets.nodes, axis=1)
    assert len(np.unique(faces, axis=0)) == len(faces)
    for other in comm.allgather(facets.nodes):
        assert np.array_equal(other, facets.nodes)


def test_unknown_surfaces_are_refused(comm):
    mesh = cup(comm, "axisymmetric")
    with pytest.raises(MeshError, match="body 'casting' has no surface 'outside'"):
        surface_facets(mesh, mesh.bodies["casting"], "outside")
