"""Tied pairs: two bodies that move as one."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    normal_forces,
    problem,
    pulled,
)

SOFT, STIFF = (7e9, 0.33, 2e-5), (70e9, 0.3, 1e-5)
TIED = Contact("upper", "base", "tied")


def tower(comm, model="plane-strain", symmetry=False, stabilisation="osgs", **settings):
    """Return a hot block that is pulled up and sideways, tied to a wider base."""
    pull = (1e6, 0.0, 2e6) if model == "3d" else (0.0 if symmetry else 1e6, 2e6)
    bodies = {
        "upper": body(
            elastic(*SOFT), loads=(pulled("top", *pull),), stabilisation=stabilisation
        ),
        "base": body(elastic(*STIFF), formulation="displacement"),
    }
    mesh = blocks(comm, model, base=(0.04, 0.02), symmetry=symmetry, size=0.01)
    made = problem(mesh, bodies, {"base": [fixed("bottom", "all")]}, [TIED], **settings)
    heat(made, lambda x: 20 + 1e3 * x[:, 0])
    made.equilibrium.solve(0.0)
    return made


def facing(comm, made):
    """Return the displacements of the facing nodes."""
    pairs = made.pairs[0]
    d = pairs.points.shape[1]
    upper = everywhere(comm, motion(made, "upper")[:, :d])[pairs.secondary_nodes]
    return upper, everywhere(comm, motion(made, "base")[:, :d])[pairs.primary_nodes]


@pytest.mark.parametrize(
    ("model", "symmetry"),
    [("plane-strain", False), ("plane-strain", True), ("axisymmetric", True), ("3d", False)],
)
def test_facing_nodes_move_equally_and_nothing_is_lost(comm, model, symmetry):
    made = tower(comm, model, symmetry)
    upper, base = facing(comm, made)
    size = np.abs(everywhere(comm, upper)).max()
    np.testing.assert_allclose(upper, base, atol=1e-12 * size)
    state = made.contact_states()[0]
    force = comm.allreduce(state.force.sum(axis=0))
    area = comm.allreduce(made.pairs[0].areas.sum())
    up = 2 if model == "3d" else 1
    assert force[up] == pytest.approx(-2e6 * area, rel=1e-9)
    assert np.all(state.closed)
    np.testing.assert_array_equal(state.gap, 0.0)
    assert everywhere(comm, normal_forces(made)).min() < 0


def test_iterative_solver_agrees(comm):
    direct, iterative = (tower(comm, linear=k, tolerance=1e-9) for k in ("direct", "iterative"))
    for name in direct.bodies:
        u = everywhere(comm, motion(direct, name)[:, :2])
        found = everywhere(comm, motion(iterative, name)[:, :2])
        np.testing.assert_allclose(found, u, atol=1e-6 * np.abs(u).max())


@pytest.mark.serial
def test_tie_against_dense_multipliers(comm):
    """The solution is that of [A Cᵀ; C 0] with a row u_upper - u_base for each direction."""
    made = tower(comm, stabilisation="gls")
    assembly = made.equilibrium.balance.assembly
    A = assembly.matrix().convert("dense").getDenseArray()
    found = assembly.unknowns.array_r.copy()
    assembly.unknowns.set(0.0)
    load = -assembly.residual().array_r.copy()
    bottom = np.flatnonzero(np.abs(points_of(made, "base")[:, 1] + 0.02) < 1e-9)
    rows = []
    for k in range(2):
        for node in bottom:
            rows.append({int(made.layout.dofs(1, [node], k)[0]): 1.0})
        for s, p in zip(made.pairs[0].secondary_nodes, made.pairs[0].primary_nodes, strict=True):
            u, v = (int(made.layout.dofs(b, [n], k)[0]) for b, n in ((0, s), (1, p)))
            rows.append({u: 1.0, v: -1.0})
    C = np.zeros((len(rows), len(A)))
    for i, row in enumerate(rows):
        C[i, list(row)] = list(row.values())
    whole = np.block([[A, C.T], [C, np.zeros((len(C), len(C)))]])
    expected = np.linalg.solve(whole, np.concatenate((load, np.zeros(len(C)))))[: len(A)]
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def points_of(made, name):
    return made.bodies[name].mesh.nodes.tabulate_dof_coordinates()


def test_tied_and_other_interfaces_go_together(comm):
    """A pin tied into a ring that touches nothing else gives the ring no way to float."""
    mesh = generated(
        comm, "plane-strain", "core_in_ring", ["core", "casting"],
        core_radius=0.03, outer_radius=0.05, size=0.006,
    )  # fmt: skip
    bodies = {"core": body(elastic(*STIFF)), "casting": body(elastic(*SOFT))}
    made = problem(mesh, bodies, {}, [Contact("casting", "core", "tied")])
    heat(made, 120.0)
    made.equilibrium.solve(0.0)
    # The ring wants to grow more than the core: the tie pulls everywhere.
    assert everywhere(comm, normal_forces(made)).max() < 0
    assert made.equilibrium.support_force() == 0.0
