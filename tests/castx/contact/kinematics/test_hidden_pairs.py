"""Pairs without a row of their own, on an assembly whose die parts at faces of the casting."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.interfaces import Interface
from castx.contact.choice import Contact
from castx.contact.kinematics.hidden_pairs import hidden_pair_warnings
from castx.domain.pairs.pairing import case_pairs
from tests.elastic_bodies import body, drawn, elastic, problem
from tests.multi_body import BODIES, CASTING_FIRST, MOULD_FIRST, draw


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    comm = MPI.COMM_WORLD
    folder = comm.bcast(tmp_path_factory.mktemp("multi"))
    return drawn(comm, "3d", BODIES, folder / "bodies.msh", draw)


def interfaces(names, tied=()):
    return [
        Interface.read(
            {"bodies": list(n), "contact": {"method": "tied" if n in tied else "condensed"}}
        )
        for n in names
    ]


def warnings(mesh, described, rigid=()):
    return hidden_pair_warnings(described, case_pairs(mesh, described), rigid, mesh.comm)


def rows_missing(mesh, names):
    """Return the pairs of each interface that the equilibrium has no row for."""
    bodies = {name: body(elastic(7e10, 0.3)) for name in BODIES}
    made = problem(mesh, bodies, {}, [Contact(*n) for n in names])
    ends = np.cumsum([len(pairs.areas) for pairs in made.pairs])[:-1]
    parts = np.split(~made.gaps.free, ends)
    return {
        "/".join(n): mesh.comm.allreduce(int(part.sum()))
        for n, part in zip(names, parts, strict=True)
    }


def test_each_pair_that_the_equilibrium_leaves_out_is_told(mesh):
    """Counted from the unknowns of the equilibrium, which knows nothing of the warning."""
    told = Counter()
    for text in warnings(mesh, interfaces(CASTING_FIRST)):
        found = re.match(r"interface (\S+): (\d+) of \d+ pairs carry no force", text)
        assert found is not None
        told[found[1]] += int(found[2])
        parting = f'bodies = ["{found[1].split("/")[1]}"' in text.replace("'", '"')
        assert parting or "more faces there than a node can be held by" in text
    missing = {name: count for name, count in rows_missing(mesh, CASTING_FIRST).items() if count}
    assert told == missing
    assert "casting/upper" in told


def test_the_mould_named_first_leaves_none_out(mesh):
    assert warnings(mesh, interfaces(MOULD_FIRST)) == []
    assert not any(rows_missing(mesh, MOULD_FIRST).values())


def test_a_mould_that_is_tied_or_rigid_holds_what_its_parts_touch(mesh):
    tied = CASTING_FIRST[4:]
    assert warnings(mesh, interfaces(CASTING_FIRST, tied)) == []
    assert warnings(mesh, interfaces(CASTING_FIRST), BODIES[1:]) == []


@pytest.mark.ranks
def test_bodies_tied_to_another_one_still_part(mesh):
    tied = (("chill", "lower"),)
    described = interfaces(CASTING_FIRST, tied)
    told = " ".join(warnings(mesh, described))
    pairs = mesh.comm.allreduce(len(case_pairs(mesh, described)["casting/upper"].areas))
    assert re.search(rf"casting/upper: \d+ of {pairs} pairs carry no force", told)


@pytest.mark.ranks
def test_a_node_that_meets_too_many_faces_of_one_die_cannot_be_helped_by_tying(mesh):
    """The bodies of the die cannot part, so the advice for those that can would mislead."""
    described = interfaces(CASTING_FIRST[:4])
    ties = interfaces(CASTING_FIRST[4:], CASTING_FIRST[4:])
    directions = (*np.eye(3), np.ones(3) / np.sqrt(3.0))
    found = case_pairs(mesh, described)
    upper = found["casting/upper"]
    crowded = {
        interface.name: replace(
            upper,
            primary=interface.primary,
            normals=np.tile(direction, (len(upper.areas), 1)),
        )
        for interface, direction in zip(described, directions, strict=True)
    }
    one_each = {name: single(pairs) for name, pairs in crowded.items()}
    tied = hidden_pair_warnings([*described, *ties], one_each, (), mesh.comm)
    assert len(tied) == 1
    assert "casting/upper" in tied[0] and "more faces there than a node can be held by" in tied[0]
    free = hidden_pair_warnings(described, one_each, (), mesh.comm)
    assert len(free) == 1 and "can move apart" in free[0]


@pytest.mark.ranks
def test_what_is_hidden_on_one_rank_is_told_on_all(mesh):
    """One rank after the other is the only one with pairs, and all say the same."""
    comm, described = mesh.comm, interfaces(CASTING_FIRST, (("chill", "lower"),))
    found, told = case_pairs(mesh, described), []
    for rank in range(comm.size):
        numbers = slice(None if rank == comm.rank else 0)
        alone = {name: chosen(pairs, numbers) for name, pairs in found.items()}
        texts = comm.allgather(hidden_pair_warnings(described, alone, (), comm))
        assert all(text == texts[0] for text in texts)
        told += texts[0]
    assert any("casting/upper" in text for text in told)


def single(pairs):
    """Return one pair of each node."""
    return chosen(pairs, np.unique(pairs.secondary_local, return_index=True)[1])


def chosen(pairs, numbers):
    """Return some of the pairs."""
    return replace(
        pairs,
        **{
            name: getattr(pairs, name)[numbers]
            for name in ("secondary_nodes", "secondary_local", "primary_nodes", "original_nodes",
                         "points", "areas", "area_vectors", "normals")
        },
    )  # fmt: skip
