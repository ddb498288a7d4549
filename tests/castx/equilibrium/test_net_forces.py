"""What acts on bodies and what is missing, against sums over the nodes by hand."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.net_forces import NetForces
from castx.mechanics.clamp import SurfaceClamp
from castx.tables import Table
from tests import elastic_bodies
from tests.contact_methods import EXACT
from tests.coupled_cases import cylinder, simulation
from tests.elastic_bodies import blocks, elastic, fixed, heat, problem
from tests.small_contact import two_blocks


def net_of(made) -> NetForces:
    balance = made.equilibrium.balance
    return NetForces(balance.assembly, balance.transform, balance.gaps)


@pytest.mark.ranks
@pytest.mark.parametrize("method", EXACT)
def test_what_acts_is_the_load_or_else_the_contact(comm, method):
    made = two_blocks(comm, method)
    _, forces = made.pair_values()
    found = net_of(made).acting(forces)
    upper = made.equilibrium.balance.assembly.bodies[0]
    load = upper.formulation.forms.load.reshape(-1, upper.block_size)[:, :2]
    expected = comm.allreduce(sum(float(np.hypot(*force)) for force in load))
    assert found == pytest.approx([expected, comm.allreduce(forces.sum())], rel=1e-12)
    assert net_of(made).acting(0.0 * forces)[1] == 0.0


@pytest.mark.serial
def test_a_load_of_a_micronewton_is_one(comm):
    made = two_blocks(comm)
    load = made.equilibrium.balance.assembly.bodies[0].formulation.forms.load
    _, forces = made.equilibrium.balance.pair_values(made.equilibrium.x)
    before = net_of(made).acting(forces)[0]
    load *= 1e-6 / before
    assert net_of(made).acting(forces)[0] == pytest.approx(1e-6, rel=1e-12)


@pytest.mark.ranks
@pytest.mark.parametrize("method", EXACT)
def test_what_is_missing_is_the_resultant_on_the_nodes(comm, method):
    """Of a force in the condensed unknowns, a part acts on the facing body."""
    made = two_blocks(comm, method)
    balance, layout = made.equilibrium.balance, made.layout
    nodal = np.zeros(layout.size_local)
    for b, (body, force) in enumerate(zip(balance.assembly.bodies, (3.0, 5.0), strict=True)):
        own = nodal[layout.local_slice(b)].reshape(-1, body.block_size)
        count = comm.allreduce(len(own))
        own[:, 0], own[:, 1] = 0.6 * force / count, 0.8 * force / count
        own[:, 2:] = 1e3  # rows of the pressure are no forces
    rows = balance.contact.unknowns.extended(balance.transform.forces_on_unknowns(nodal))
    assert net_of(made).missing(rows) == pytest.approx([3.0, 5.0], rel=1e-12)


def test_radial_forces_of_an_axisymmetric_body_have_no_resultant(comm):
    run = simulation(comm, cylinder(size=0.012))
    mechanics = run.problem.mechanics
    assert mechanics is not None
    balance, layout = mechanics.equilibrium.balance, mechanics.layout
    nodal = np.zeros(layout.size_local)
    body = balance.assembly.bodies[0]
    own = nodal[layout.local_slice(0)].reshape(-1, body.block_size)
    own[:, 0], own[:, 1] = 7.0, 2.0 / comm.allreduce(len(own))
    rows = balance.transform.forces_on_unknowns(nodal)
    assert net_of(mechanics).missing(rows)[0] == pytest.approx(2.0, rel=1e-12)
    run.destroy()


def test_springs_of_a_machine_count_with_the_contact(comm):
    """Without loads both act, S on each; a clamp force is a load. What is missing knows both."""
    for force, of_upper in ((0.0, 2.0), (3e4, 3e4)):
        machine = SurfaceClamp("top", Table.constant(force), 1e9)
        metal, of_metal = elastic(70e9, 0.3, 1e-5), elastic_bodies.body
        made = problem(
            blocks(comm), {"upper": of_metal(metal, clamps=[machine]), "base": of_metal(metal)},
            {"base": [fixed("bottom")]}, [Contact("upper", "base")],
        )  # fmt: skip
        heat(made, 220.0)
        made.equilibrium.solve(0.0)
        borne = made.clamp_totals()["upper/top.clamp_force"]
        assert borne > force + 1e4
        _, forces = made.pair_values()
        found = net_of(made).acting(forces)
        expected = of_upper * borne if force == 0.0 else of_upper
        assert found == pytest.approx([expected, borne], rel=1e-9)
        errors = made.equilibrium.force_errors()
        assert max(errors.values()) < 1e-9
