"""Multigrid of condensed contact when a casting with a liquid core comes off its mould."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.newton import EquilibriumReport
from castx.equilibrium.problem import MechanicalProblem
from tests.elastic_bodies import (
    body,
    elastic,
    everywhere,
    fixed,
    gaps,
    generated,
    motion,
    problem,
)

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


@pytest.mark.slow
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


SOLIDUS, RIM = 560.0, 0.03
"""Solidus [°C] and radius [m] of a casting whose skin freezes."""


def melt_in_cup(comm, size: float, **settings) -> MechanicalProblem:
    """Return a quarter of a cylinder of liquid alloy in its mould, nothing of it solid yet."""
    mesh = generated(
        comm, "3d", "cylinder_in_mould", ["casting", "mould"], radius=RIM, height=0.05,
        wall=0.01, floor=0.01, size=size, sector="quarter",
    )  # fmt: skip
    alloy = elastic(
        50e9, 0.33, 2.4e-5, solidus=SOLIDUS, liquidus=610.0, latent_heat=4e5,
        liquid={"model": "viscous", "viscosity": 1e6, "coherency": 0.9},
    )  # fmt: skip
    bodies = {
        "casting": body(alloy, SOLIDUS, body_force=(0.0, 0.0, -2.6e4), starts_liquid=True),
        "mould": body(elastic(200e9, 0.3, 1.2e-5), 200.0, formulation="displacement"),
    }
    conditions = {"mould": [fixed("base", "all")]}
    return problem(mesh, bodies, conditions, [Contact("casting", "mould")], **settings)


def freeze(made: MechanicalProblem, size: float) -> list[EquilibriumReport]:
    """Take three steps, at the end of the last strips of the skin are solid; return the reports."""
    found = []
    for skin, step, time in ((-1.0, 0.01, 0.01), (-1.0, 2.0, 2.01), (1.1 * size, 2.0, 4.01)):
        for name, part in made.bodies.items():
            points = part.mesh.points
            strips = np.sin(10 * np.arctan2(points[:, 1], points[:, 0])) > -0.2
            solid = (np.hypot(points[:, 0], points[:, 1]) > RIM - skin) & strips
            if name == "mould":
                part.update_state(np.full(len(points), 200.0 + time), np.ones(len(points)), step)
            else:
                cold = SOLIDUS - 20.0 - 200.0 * points[:, 2]
                part.update_state(np.where(solid, cold, 600.0), np.where(solid, 1.0, 0.0), step)
        found.append(made.equilibrium.solve(time))
        made.equilibrium.commit()
    return found


@pytest.mark.sampled
@pytest.mark.parametrize("size", [0.01, 0.006])
def test_a_skin_that_freezes_round_a_melt_needs_few_iterations(comm, size):
    """A longer step makes the melt softer, then strips freeze that are 10⁴ times stiffer.

    Coarse spaces of the stiffer melt, aggregates of stiff and soft nodes, and pairs that opened
    since the last set-up take up to a hundred iterations.
    """
    to_six_digits = {"ksp_rtol": 1e-6}
    made = melt_in_cup(comm, size, linear="iterative", tolerance=1e-3, options=to_six_digits)
    reports = freeze(made, size)
    assert reports[-1].contact_changes > 10
    assert max(count for report in reports for count in report.linear_solves) <= 36


@pytest.mark.sampled
def test_a_freezing_skin_is_the_same_by_factors_and_by_multigrid(comm):
    solved = [melt_in_cup(comm, 0.01, linear=k, tolerance=1e-9) for k in ("direct", "iterative")]
    for made in solved:
        freeze(made, 0.01)
    exact, found = ([motion(made, name) for name in made.bodies] for made in solved)
    closed, expected = (everywhere(comm, made.equilibrium.active.closed) for made in solved)
    np.testing.assert_array_equal(closed, expected)
    largest = max(np.abs(everywhere(comm, u[:, :3].copy())).max() for u in exact)
    for u, v in zip(exact, found, strict=True):
        np.testing.assert_allclose(v[:, :3], u[:, :3], atol=1e-8 * largest)
