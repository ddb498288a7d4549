"""A skin that faces two bodies passes each of its areas to one of them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import gmsh
import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.domain.pairs.areas import area_text, area_warning, area_warnings
from castx.domain.pairs.face_pairs import face_interface
from castx.domain.pairs.facing import SurfacePoints, faced
from castx.domain.pairs.sharing import shared_pairs
from castx.errors import MeshError
from tests.castx.domain.interface_meshes import pairs_by
from tests.elastic_bodies import drawn, everywhere

WIDTH, HEIGHT, SPLIT, GAP = 0.02, 0.01, 4 / 7, 1e-4
RULE = Pairing(kind="node-to-face", surfaces=("under", "over"))


def draw():
    """Draw a block above two bases that meet under a node of the block."""
    geo, faces = gmsh.model.geo, {}
    for name, left, right, low, cells in (
        ("upper", 0.0, WIDTH, GAP, 7),
        ("one", 0.0, SPLIT * WIDTH, -HEIGHT, 5),
        ("two", SPLIT * WIDTH, WIDTH, -HEIGHT, 4),
    ):
        corners = ((left, low), (right, low), (right, low + HEIGHT), (left, low + HEIGHT))
        p = [geo.addPoint(x, y, 0.0) for x, y in corners]
        sides = [geo.addLine(p[k], p[(k + 1) % 4]) for k in range(4)]
        surface = geo.addPlaneSurface([geo.addCurveLoop(sides)])
        for k in (0, 2):
            geo.mesh.setTransfiniteCurve(sides[k], cells + 1)
        faces[name] = (surface, sides[0] if name == "upper" else sides[2])
    geo.synchronize()
    for name, (surface, _) in faces.items():
        gmsh.model.addPhysicalGroup(2, [surface], name=name)
    gmsh.model.addPhysicalGroup(1, [faces["upper"][1]], name="under")
    gmsh.model.addPhysicalGroup(1, [faces["one"][1], faces["two"][1]], name="over")
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 0.005)
    gmsh.model.mesh.generate(2)


@pytest.fixture
def mesh(comm, shared_tmp_path):
    file = shared_tmp_path / "three.msh"
    return drawn(comm, "plane-strain", ["upper", "one", "two"], file, draw)


def shared(mesh, rule=RULE):
    sides = [face_interface(mesh, "upper", base, rule) for base in ("one", "two")]
    return shared_pairs(mesh, sides)


def total(comm, found):
    return comm.allreduce(sum(pairs.areas.sum() for pairs in found))


@pytest.mark.ranks
def test_areas_of_all_pairs_add_up_to_the_skin_once(comm, mesh):
    alone = [pairs_by(RULE, mesh, "upper", base) for base in ("one", "two")]
    assert total(comm, alone) == pytest.approx(8 / 7 * WIDTH)  # the node in both counts twice
    one, two = shared(mesh)
    assert total(comm, [one, two]) == pytest.approx(WIDTH, rel=1e-12)
    assert total(comm, [one]) == pytest.approx(SPLIT * WIDTH, rel=1e-12)
    np.testing.assert_allclose(one.normals, np.tile([0.0, 1.0], (len(one.areas), 1)), atol=1e-12)
    assert one.primary_area == pytest.approx(SPLIT * WIDTH, rel=1e-12)
    assert two.primary_area == pytest.approx((1 - SPLIT) * WIDTH, rel=1e-12)


@pytest.mark.ranks
def test_a_node_that_stands_in_two_interfaces_shares_its_area(comm, mesh):
    """The same primary surface twice: every part is equally close to both."""
    interface = face_interface(mesh, "upper", "one", RULE)
    lone = pairs_by(RULE, mesh, "upper", "one")
    for pairs in shared_pairs(mesh, [interface, interface]):
        np.testing.assert_allclose(pairs.areas, 0.5 * lone.areas, rtol=1e-12)
        np.testing.assert_allclose(pairs.normals, lone.normals, atol=1e-12)


def beside(mesh, tilt=0.0, nearer=0.0):
    """Return the interface of the block and a base, and the same with another primary surface.

    Args:
        mesh: of the bodies.
        tilt: by which the normals of that surface are turned [rad].
        nearer: distance by which it is closer to the block, in sizes of a facet of the block.
    """
    interface = face_interface(mesh, "upper", "one", RULE)
    own, other = interface.facets
    up = np.array([0.0, nearer * WIDTH / 7])
    normals = np.tile([np.sin(tilt), np.cos(tilt)], (len(other.normals), 1))
    moved = replace(other, points=other.points + up, normals=normals)
    return interface, replace(interface, facets=(own, moved))


@pytest.mark.serial
def test_surfaces_a_millionth_of_a_facet_apart_are_equally_close(mesh):
    first, second = shared_pairs(mesh, beside(mesh, nearer=3e-7))
    np.testing.assert_allclose(first.areas, second.areas, rtol=1e-12)
    with pytest.raises(MeshError, match="lies closer to another"):
        shared_pairs(mesh, beside(mesh, nearer=3e-6))


@pytest.mark.serial
@pytest.mark.parametrize("degrees, share", [(59.9, 1.0), (60.1, 0.0)])
def test_a_surface_turned_by_more_than_sixty_degrees_has_no_area(mesh, degrees, share):
    (found,) = shared_pairs(mesh, [beside(mesh, tilt=np.radians(degrees))[1]])
    assert found.primary_area == pytest.approx(share * SPLIT * WIDTH, rel=1e-12)


def test_beyond_the_search_distance_a_node_faces_nothing(comm, mesh):
    near = pairs_by(replace(RULE, search_distance=1.01 * GAP), mesh, "upper", "one")
    whole = pairs_by(RULE, mesh, "upper", "one")
    assert comm.allreduce(len(near.areas)) == comm.allreduce(len(whole.areas)) > 0
    with pytest.raises(MeshError, match=r"contact.search_distance \(9e-05 m\)"):
        pairs_by(replace(RULE, search_distance=0.9 * GAP), mesh, "upper", "one")


def test_by_default_a_node_reaches_as_far_as_the_coarser_facet(comm, mesh):
    facets = face_interface(mesh, "upper", "one", RULE).facets[1]
    size = SPLIT * WIDTH / 5
    heights = np.array([0.9, 1.1, 1.9, 2.1]) * size
    places = np.stack([np.full(4, 0.3 * WIDTH), heights], axis=1)
    down = np.tile([0.0, -1.0], (4, 1))
    for own, reached in ((0.5 * size, 1), (2 * size, 3)):
        found = faced(SurfacePoints(places, down, np.full(4, own)), facets, None)
        np.testing.assert_allclose(found.distance[:reached], heights[:reached])
        assert np.all(np.isinf(found.distance[reached:]))


@pytest.mark.ranks
def test_areas_of_both_sides_are_compared(comm, mesh):
    one, _ = shared(mesh)
    exact = replace(one, primary_area=total(comm, [one]))
    assert area_warning(exact, comm) == "" == area_warning(replace(one, primary_area=None), comm)
    half = replace(one, primary_area=0.5 * total(comm, [one]))
    assert "differ by 50 %" in area_warning(half, comm)
    assert area_text(half, comm) in area_warning(half, comm)
    assert everywhere(comm, one.areas).min() > 0


@pytest.mark.serial
def test_sides_of_a_curved_gap_may_differ(comm, mesh):
    one, _ = shared(mesh)
    pairs = {one.name: replace(one, primary_area=0.5 * total(comm, [one]))}

    def interface(heat):
        return SimpleNamespace(name=one.name, heat=heat)

    for heat in (None, SimpleNamespace(curved=None)):
        assert len(area_warnings([interface(heat)], pairs, comm)) == 1
    assert area_warnings([interface(SimpleNamespace(curved=object()))], pairs, comm) == []
