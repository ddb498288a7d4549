"""Rows of conditions and pairs: what is placed where, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.contact.kinematics.placement import RowPlacement
from castx.contact.kinematics.rows import InterfaceRows, Treatment
from castx.domain.pairs.node_pairs import node_pairs
from castx.errors import CaseError
from castx.mechanics.fixed_directions import SurfaceDisplacement, fixed_directions
from castx.solvers.layout import Layout
from tests.elastic_bodies import blocks, everywhere, fixed
from tests.partitions import PARTITION, on_the_last

NAMES = ("upper", "base")


def placed(comm, conditions, treatment=Treatment.CONDENSED, normal=None) -> RowPlacement:
    mesh = blocks(comm, symmetry=False, size=0.01)
    maps = [mesh.bodies[n].nodes.dofmap.index_map for n in NAMES]
    directions = [
        fixed_directions(mesh.bodies[n], mesh.model, conditions.get(n, ())) for n in NAMES
    ]
    pairs = node_pairs(mesh, *NAMES)
    if normal is not None:
        vectors = pairs.areas[:, None] * np.array(normal)
        pairs = replace(pairs, area_vectors=vectors)
    rows = [InterfaceRows(pairs, treatment)]
    return RowPlacement(Layout(comm, maps, [3, 2]), NAMES, 2, directions, rows)


@pytest.mark.parametrize("treatment", list(Treatment))
def test_what_becomes_of_the_pairs(comm, treatment):
    """Only the treatments that make motions unknowns take rows of the secondary nodes."""
    found = placed(comm, {}, treatment)
    interface = found.interfaces[0]
    counts = everywhere(comm, found.rows[0].count[interface.pairs.secondary_local])
    rows = {
        Treatment.UNCHANGED: 0, Treatment.CONDENSED: 1, Treatment.SLIDING: 2, Treatment.TIED: 2,
    }[treatment]  # fmt: skip
    assert np.all(counts == rows) and len(counts) == 3
    assert np.all(interface.free)
    motions = comm.allreduce(int(np.count_nonzero(interface.tangent_local >= 0)))
    assert motions == (3 if treatment is Treatment.SLIDING else 0)
    assert len(found.prescribed) == (1 if treatment is Treatment.TIED else 0)


def test_prescribed_rows_come_first_and_symmetric_ones_turn_the_normal(comm):
    found = placed(comm, {"upper": [fixed("top", "all")]})
    assert [len(everywhere(comm, item.local)) for item in found.prescribed] == [3, 3]
    normals = everywhere(comm, found.interfaces[0].normals)
    np.testing.assert_allclose(normals, np.tile([0.0, 1.0], (3, 1)), atol=1e-15)


@pytest.mark.ranks
def test_surfaces_that_move_equally_are_kept_for_the_transform(comm):
    found = placed(comm, {"upper": [SurfaceDisplacement("top", "normal", None)]})
    [motion] = found.equal_motions
    assert motion.body == 0 and len(everywhere(comm, motion.nodes)) == 3
    assert np.all(everywhere(comm, motion.slots) == 0) and found.prescribed == []
    assert sorted(comm.allgather(motion.first), key=str) == [0, *[None] * (comm.size - 1)]


@pytest.mark.ranks
def test_refuses_a_uniform_surface_with_a_prescribed_direction(comm):
    refuse_uniform(comm)


@pytest.mark.ranks
def test_refuses_it_on_ranks_without_its_nodes(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    refuse_uniform(comm)


def refuse_uniform(comm):
    uniform = SurfaceDisplacement("top", "normal", None)
    with pytest.raises(CaseError, match="upper/top normal is uniform, but another condition"):
        placed(comm, {"upper": [fixed("top", "y"), uniform]})


@pytest.mark.ranks
def test_refuses_a_pair_that_only_the_primary_could_open(comm, monkeypatch):
    """Also on ranks without pairs."""
    monkeypatch.setattr(PARTITION, on_the_last)
    with pytest.raises(CaseError, match="the conditions of 'upper' hold its node"):
        placed(comm, {"upper": [fixed("base", "all")]})


def test_a_node_that_slides_along_a_plane_leaves_what_it_does_not_graze(comm):
    """Held along x, it can leave a partner in y, but hardly one whose normal is within 3° of x."""
    held = {"upper": [fixed("base", "x")]}
    for sine in (1.0, 0.06):
        found = placed(comm, held, normal=(np.sqrt(1 - sine**2), sine))
        assert np.all(found.interfaces[0].free)
    with pytest.raises(CaseError, match="the conditions of 'upper' hold its node"):
        placed(comm, held, normal=(np.sqrt(1 - 0.04**2), 0.04))
