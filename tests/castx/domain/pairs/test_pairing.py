"""The rule of an interface decides how its nodes are paired."""

import numpy as np
import pytest

from castx.case.contact import BY_NODES, Pairing
from castx.case.interfaces import Interface
from castx.domain.pairs.face_pairs import face_interface, facing_nodes
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.pairs.pairing import case_pairs
from castx.domain.pairs.patches import pairs_by_patch
from tests.castx.domain.interface_meshes import NAMES, box, pairs_by

FACES = Pairing(kind="node-to-face")


@pytest.fixture
def mesh(comm):
    return box(comm, "plane-strain", "simplices")


def pairs_of_case(mesh, interface):
    return case_pairs(mesh, [interface])[interface.name]


def same(one, other):
    assert one.name == other.name and (one.faces is None) == (other.faces is None)
    for key in ("secondary_nodes", "primary_nodes", "areas", "normals", "gap"):
        np.testing.assert_array_equal(getattr(one, key), getattr(other, key))


def test_each_rule_has_its_pairs(mesh):
    sharp = Pairing("patches", np.radians(30))
    same(pairs_by(BY_NODES, mesh, *NAMES), node_pairs(mesh, *NAMES))
    same(pairs_by(sharp, mesh, *NAMES), pairs_by_patch(mesh, *NAMES, np.radians(30)))
    facing = facing_nodes(mesh, face_interface(mesh, *NAMES, FACES))
    same(pairs_by(FACES, mesh, *NAMES), facing.pairs(facing.areas, facing.outward))


@pytest.mark.parametrize(
    "contact, rule",
    [
        ({}, BY_NODES),
        ({"normals": "patches", "sharp_angle": "30 deg"}, Pairing("patches", np.radians(30))),
        ({"pairing": "node-to-face"}, FACES),
    ],
)
def test_an_interface_of_a_case_is_paired_by_its_keys(mesh, contact, rule):
    interface = Interface.read({"bodies": list(NAMES), "contact": contact})
    same(pairs_of_case(mesh, interface), pairs_by(rule, mesh, *NAMES))


def test_the_initial_gap_adds_to_the_meshed_one(mesh):
    gap = {"along": "x", "table": [[-1, -1], [1, 1]]}
    interface = Interface.read({"bodies": list(NAMES), "contact": {"initial_gap": gap}})
    pairs = pairs_of_case(mesh, interface)
    np.testing.assert_allclose(pairs.gap, pairs.points[:, 0], atol=1e-15)
    faces = {"initial_gap": "1 mm", "pairing": "node-to-face"}
    interface = Interface.read({"bodies": list(NAMES), "contact": faces})
    pairs = pairs_of_case(mesh, interface)
    facing = facing_nodes(mesh, face_interface(mesh, *NAMES, FACES))
    meshed = facing.pairs(facing.areas, facing.outward).gap
    np.testing.assert_allclose(pairs.gap, meshed + 1e-3, atol=1e-15)
