"""Multigrid of condensed contact when a casting with a liquid core comes off its mould."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.problem import MechanicalProblem
from tests.elastic_bodies import body, elastic, everywhere, fixed, gaps, generated, problem

RADIUS, HEIGHT = 0.04, 0.1


def shrunk_cylinder(comm, mould: str, linear: str) -> MechanicalProblem:
    """Return a casting whose shell has cooled, the more the lower, to be solved to 1e-3."""
    mesh = generated(
        comm, "3d", "cylinder_in_mould", ["casting", "mould"], radius=RADIUS, height=HEIGHT,
        wall=0.04, floor=0.02, size=0.0122,
    )  # fmt: skip
    alloy = elastic(
        70e9, 0.33, 2.4e-5, solidus=600.0, liquidus=601.0, latent_heat=4e5,
        liquid={"model": "viscous", "viscosity": 1e6, "coherency": 0.7},
    )  # fmt: skip
    bodies = {
        "casting": body(alloy, 600.0, body_force=(0.0, 0.0, -2.6e4), starts_liquid=True),
        "mould": body(elastic(200e9, 0.33, 1.2e-5), 200.0, formulation="displacement"),
    }
    if mould == "rigid":
        del bodies["mould"]
    made = problem(
        mesh, bodies, {"mould": [fixed("base", "all")]}, [Contact("casting", "mould")],
        tolerance=1e-3, linear=linear,
    )  # fmt: skip
    points = made.bodies["casting"].mesh.points
    shell = np.hypot(points[:, 0], points[:, 1]) > RADIUS / 2
    cooled = 600.0 - 40.0 * (0.4 - points[:, 2] / HEIGHT)
    made.bodies["casting"].update_state(cooled, np.where(shell, 1.0, 0.0), 1.0)
    if mould == "elastic":
        nodes = len(made.bodies["mould"].mesh.points)
        made.bodies["mould"].update_state(np.full(nodes, 200.0), np.ones(nodes), 1.0)
    return made


@pytest.mark.parametrize("mould", ["elastic", "rigid"])
def test_pairs_that_come_off_get_a_coarse_space(comm, mould):
    """Without the motion of open gaps, the last solves take more iterations than the first."""
    exact, made = (shrunk_cylinder(comm, mould, linear) for linear in ("direct", "iterative"))
    exact.equilibrium.solve(1.0)
    report = made.equilibrium.solve(1.0)
    closed = everywhere(comm, made.equilibrium.active.closed)
    assert 0.25 < closed.mean() < 0.6
    assert report.iterations <= 8
    assert len(report.linear_solves) == report.iterations
    assert sum(report.linear_solves) == report.linear_iterations
    # All of them go down to one residual; without that motion they take up to 41, the first 23.
    assert max(report.linear_solves[1:]) < 1.1 * report.linear_solves[0]
    found, expected = gaps(comm, made), gaps(comm, exact)
    assert np.abs(found - expected).max() < 1e-4 * expected.max()
