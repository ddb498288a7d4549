"""Resultants of nodal forces: force, and moment about the centre of the volume."""

from __future__ import annotations

import numpy as np
import pytest

from castx.equilibrium.supports.resultants import NodalResultants
from tests.elastic_bodies import blocks, body, elastic, places, problem
from tests.small_contact import SOFT


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "3d", "axisymmetric"])
def test_a_force_at_every_node(comm, model):
    """Forces f(x) of the nodes, given on the unknowns v as Pᵀf."""
    mesh = blocks(comm, model, symmetry=model == "axisymmetric", size=0.01)
    made = problem(mesh, {n: body(elastic(*SOFT)) for n in ("upper", "base")}, {})
    transform = made.equilibrium.balance.transform
    nodal, expected = np.zeros(made.layout.size_local), {}
    centre = {"upper": 0.015, "base": -0.01}
    for b, (name, part) in enumerate(made.bodies.items()):
        points = places(made, name)
        forces = 1.0 + np.sin(50.0 * points[:, ::-1] + b)
        own = nodal[made.layout.local_slice(b)].reshape(-1, part.block_size)
        own[:, : part.dimension] = forces
        middle = np.zeros(part.dimension)
        middle[-1] = centre[name]
        arms = points - middle
        out_of_plane = [(0, 0), (0, 3 - part.dimension)]
        moment = np.cross(np.pad(arms, out_of_plane), np.pad(forces, out_of_plane)).sum(axis=0)
        if part.dimension == 2:
            moment = moment[2:]
        expected[name] = (comm.allreduce(forces.sum(axis=0)), comm.allreduce(moment))
    found = NodalResultants(transform, list(made.bodies.values())).of(
        transform.forces_on_unknowns(nodal)
    )
    for name, (force, moment) in expected.items():
        np.testing.assert_allclose(found[name].force, force, rtol=1e-10)
        if model != "axisymmetric":
            np.testing.assert_allclose(found[name].moment, moment, rtol=1e-8, atol=1e-10)
        else:
            assert found[name].moment.size == 0
