"""Blocks of the preconditioner: which bodies are one, and what that saves."""

from __future__ import annotations

from mpi4py import MPI

import gmsh
import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium import building
from castx.equilibrium.body_blocks import moving_together
from tests.coupled_cases import final_state
from tests.elastic_bodies import body, drawn, elastic, everywhere, fixed, motion, problem, pulled

LEAVES = ("first", "second", "third", "fourth")
LENGTH, WIDTH, THICKNESS = 0.04, 0.004, 0.002


def test_groups_are_what_ties_join():
    assert moving_together(3, []) == [[0], [1], [2]]
    assert moving_together(5, [(3, 1), (4, 3), (2, 0)]) == [[0, 2], [1, 3, 4]]


def leaves():
    """Put a stack of plates that share their faces into the current gmsh model."""
    occ = gmsh.model.occ
    plates = [
        (3, occ.addBox(0, 0, k * THICKNESS, LENGTH, WIDTH, THICKNESS)) for k in range(len(LEAVES))
    ]
    _, pieces = occ.fragment(plates[:1], plates[1:])
    occ.synchronize()
    for name, [(_, tag)] in zip(LEAVES, pieces, strict=True):
        gmsh.model.addPhysicalGroup(3, [tag], name=name)
    for name, x in (("root", 0.0), ("end", LENGTH)):
        low, high = (x - 1e-6, -1.0, -1.0), (x + 1e-6, 1.0, 1.0)
        faces = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*low, *high, 2)]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", THICKNESS)
    gmsh.model.mesh.generate(3)


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    comm = MPI.COMM_WORLD
    folder = comm.bcast(tmp_path_factory.mktemp("leaves"))
    return drawn(comm, "3d", LEAVES, folder / "leaves.msh", leaves)


def bent(mesh, linear, second="displacement"):
    """Return a leaf spring of plates that are tied to each other, bent at its end."""
    steel = elastic(200e9, 0.3)
    bodies = {
        name: body(
            steel,
            formulation=second if name == "second" else "displacement",
            loads=(pulled("end", 0.0, 0.0, 1e5),),
        )
        for name in LEAVES
    }
    ties = [Contact(a, b, "tied") for a, b in zip(LEAVES[1:], LEAVES[:-1], strict=True)]
    clamps = {name: [fixed("root", "all")] for name in LEAVES}
    return problem(mesh, bodies, clamps, ties, linear=linear, tolerance=1e-4)


def deflection(comm, made):
    found = [motion(made, name)[:, 2] for name in LEAVES]
    return np.abs(everywhere(comm, np.concatenate(found))).max()


def test_tied_bodies_are_solved_for_together(comm, mesh, monkeypatch):
    """One by one the plates take up the bending of the others bit by bit."""
    exact, together = bent(mesh, "direct"), bent(mesh, "iterative")
    exact.equilibrium.solve(0.0)
    iterations = together.equilibrium.solve(0.0).linear_iterations
    assert deflection(comm, together) == pytest.approx(deflection(comm, exact), rel=1e-4)
    assert iterations <= 20
    monkeypatch.setattr(building, "moving_together", lambda count, _: [[b] for b in range(count)])
    alone = bent(mesh, "iterative").equilibrium.solve(0.0).linear_iterations
    assert alone > 3 * iterations


@pytest.mark.ranks
def test_bodies_of_one_kind_of_unknowns_are_solved_for_together(comm, mesh, monkeypatch):
    """And those of a body with pressures by itself, although it is tied to the others."""
    given, made = [], building.body_blocks
    monkeypatch.setattr(building, "body_blocks", lambda *parts: given.append(parts) or made(*parts))
    bent(mesh, "iterative", second="mixed")
    assert given[0][2] == [[0], [1], [2, 3]]


def sticking(comm):
    """Return the linear iterations of the first step of a casting that sticks in its mould."""
    data = {
        "geometry": {"generator": "box_in_mould", "model": "3d", "box": [0.05, 0.08, 0.07],
                     "wall": 0.05, "size": 0.03},
        "bodies": [
            {"name": "casting", "material": "GJL-250", "temperature": 1236.0},
            {"name": "mould", "material": "steel-carbon", "temperature": 250.0},
        ],
        "interfaces": [
            {"bodies": ["mould", "casting"], "contact": {"friction": 0.1},
             "heat": {"law": "constant", "closed": 100.0}},
        ],
        "boundaries": [{"on": "mould/base", "displacement": {"normal": 0.0}}],
        "loads": {"gravity": [0.0, 0.0, -9.81]},
        "time": {"end": 0.2, "fixed_step": 0.2},
        "solver": {"linear": "iterative"},
    }  # fmt: skip
    return final_state(comm, data).counters.linear_iterations


def test_bodies_that_stick_are_solved_for_together(comm, monkeypatch):
    together = sticking(comm)
    assert together <= 40
    monkeypatch.setattr(building, "_tied_together", lambda bodies, _: [[0], [1]])
    alone = sticking(comm)
    assert alone > 3 * together
