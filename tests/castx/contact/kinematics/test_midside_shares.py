"""Mid-sides in the pairs of an interface: where they are, and in which rows they count."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.kinematics.midside_shares import quadratic_pairs
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.pairs.patches import pairs_by_patch
from castx.mechanics.midsides.midsides import Midsides
from tests.castx.domain.interface_meshes import MESHES, NAMES, pairs_by
from tests.elastic_bodies import everywhere, sorted_by_place
from tests.partitions import PARTITION, scattered, thinly_scattered

SHARP = math.radians(40)
RULES = {
    "averaged": (Pairing(), node_pairs),
    "patches": (Pairing("patches", SHARP), lambda mesh, a, b: pairs_by_patch(mesh, a, b, SHARP)),
}


def middles(comm, mesh, midsides, name):
    """Return the places of all mid-sides of a body by their global numbers."""
    own = slice(midsides.owned_midsides)
    numbers = midsides.space.dofmap.index_map.local_to_global(
        np.arange(midsides.owned_midsides, dtype=np.int32)
    )
    places = mesh.bodies[name].points[midsides.ends[own]].mean(axis=1)
    found = np.zeros((midsides.space.dofmap.index_map.size_global, places.shape[1]))
    found[everywhere(comm, numbers)] = everywhere(comm, places)
    return found


@pytest.mark.ranks
@pytest.mark.parametrize("cut", [None, scattered, thinly_scattered])
@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("name", ["box", "box in space", "cup in space"])
def test_mid_sides_of_both_bodies_lie_beside_their_pair(comm, name, rule, cut, monkeypatch):
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    mesh, (pairing, pairs_by) = MESHES[name](comm), RULES[rule]
    midsides = {name: Midsides(mesh.bodies[name], mesh.model) for name in NAMES}
    pairs = pairs_by(mesh, *NAMES)
    found = quadratic_pairs(mesh, pairs, pairing, False, midsides)
    own, other = found.shares
    assert (own.name, own.sign) == ("mid-sides of casting", 1.0)
    assert (other.name, other.sign) == ("mid-sides of mould", -1.0)
    np.testing.assert_array_equal(own.pair, other.pair)
    np.testing.assert_array_equal(own.areas, other.areas)
    np.testing.assert_array_equal(own.normals, other.normals)
    places = middles(comm, mesh, midsides["casting"], "casting")[own.midsides]
    there = middles(comm, mesh, midsides["mould"], "mould")[other.midsides]
    np.testing.assert_allclose(places, there, atol=1e-12)
    apart = np.linalg.norm(places - pairs.points[own.pair], axis=1)
    assert apart.max(initial=0.0) < 0.02
    if rule == "patches" and name != "cup in space":
        along = np.sum(own.normals * pairs.normals[own.pair], axis=1)
        np.testing.assert_allclose(along, 1.0)


@pytest.mark.ranks
@pytest.mark.parametrize("quadratic", ["casting", "mould"])
def test_only_quadratic_bodies_have_shares(comm, quadratic):
    mesh = MESHES["box"](comm)
    midsides = {quadratic: Midsides(mesh.bodies[quadratic], mesh.model)}
    found = quadratic_pairs(mesh, node_pairs(mesh, *NAMES), Pairing(), False, midsides)
    assert [shares.body for shares in found.shares] == [quadratic]
    assert found.tied == ()
    assert quadratic_pairs(mesh, found.nodes, Pairing(), False, {}).shares == ()


@pytest.mark.ranks
@pytest.mark.parametrize("cut", [None, scattered])
@pytest.mark.parametrize("name", ["box", "box in space"])
def test_tied_mid_sides_face_each_other(comm, name, cut, monkeypatch):
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    mesh = MESHES[name](comm)
    midsides = {name: Midsides(mesh.bodies[name], mesh.model) for name in NAMES}
    (tied,) = quadratic_pairs(mesh, node_pairs(mesh, *NAMES), Pairing(), True, midsides).tied
    assert tied.name == "mid-sides of casting/mid-sides of mould"
    there = middles(comm, mesh, midsides["mould"], "mould")[tied.primary_nodes]
    np.testing.assert_allclose(tied.points, there, atol=1e-12)
    own = middles(comm, mesh, midsides["casting"], "casting")[tied.secondary_nodes]
    np.testing.assert_allclose(tied.points, own, atol=1e-12)
    assert comm.allreduce(len(tied.areas)) > 10


@pytest.mark.ranks
@pytest.mark.parametrize("quadratic", ["casting", "mould"])
def test_mid_sides_tied_to_a_linear_body_face_nothing(comm, quadratic):
    mesh = MESHES["box"](comm)
    midsides = {quadratic: Midsides(mesh.bodies[quadratic], mesh.model)}
    (tied,) = quadratic_pairs(mesh, node_pairs(mesh, *NAMES), Pairing(), True, midsides).tied
    assert (tied.secondary, tied.primary) == (f"mid-sides of {quadratic}", "")
    facets = comm.allreduce(len(tied.areas))
    assert facets == 2 * (4 + 2)


@pytest.mark.ranks
@pytest.mark.parametrize("tied", [False, True])
def test_bodies_from_node_to_face_have_mid_sides_of_their_own(comm, tied):
    """On surfaces that match each body has the area that the other has, edge by edge."""
    mesh = MESHES["box in space"](comm)
    midsides = {name: Midsides(mesh.bodies[name], mesh.model) for name in NAMES}
    rule = Pairing(kind="node-to-face", surfaces=("mould", "casting"))
    found = quadratic_pairs(mesh, pairs_by(rule, mesh, *NAMES), rule, tied, midsides)
    if tied:
        assert found.shares == ()
        for name, pairs in zip(NAMES, found.tied, strict=True):
            assert (pairs.secondary, pairs.primary) == (f"mid-sides of {name}", "")
            places = middles(comm, mesh, midsides[name], name)[pairs.secondary_nodes]
            np.testing.assert_allclose(pairs.points, places, atol=1e-12)
        casting, mould = (comm.allreduce(len(pairs.areas)) for pairs in found.tied)
        assert casting == mould > 100
        return
    own, other = found.shares
    assert [(part.name, part.sign) for part in (own, other)] == [
        ("mid-sides of casting", 1.0), ("mid-sides of mould", -1.0)
    ]  # fmt: skip
    of_edges = []
    for name, part in zip(NAMES, (own, other), strict=True):
        places = middles(comm, mesh, midsides[name], name)
        vectors = np.zeros_like(places)
        np.add.at(vectors, part.midsides, part.areas[:, None] * part.normals)
        vectors = comm.allreduce(vectors)
        here = np.linalg.norm(vectors, axis=1) > 0
        of_edges.append(sorted_by_place(places[here], vectors[here])[1])
    size = np.abs(of_edges[0]).max()
    np.testing.assert_allclose(of_edges[1], of_edges[0], atol=1e-9 * size)
