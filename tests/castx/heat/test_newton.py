"""Newton iteration of the heat problem: few steps, no cycles, options."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain import compat
from castx.domain.mesh import build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.errors import ConvergenceError
from castx.heat.body import HeatBody
from castx.heat.interface import HeatExchange
from castx.heat.newton import (
    FINEST_LINEAR,
    converged,
    default_options,
    residual,
)
from castx.heat.problem import HeatProblem
from tests.castx.heat.heat_cases import (
    ALUMINIUM,
    LAWS,
    SERIES,
    advanced,
    balance_under_law,
    cylinder,
    largest,
    material,
    problem_under_law,
)


def state_of(heat: HeatProblem) -> np.ndarray:
    """Return the temperatures of all bodies on this rank, ghosts included."""
    return np.concatenate([function.x.array for function in heat.temperature.values()])


@pytest.mark.parametrize("name", LAWS)
def test_newton_stays_fast_at_large_steps(comm, name):
    mesh = cylinder(comm)
    heat = problem_under_law(mesh, *LAWS[name])
    assert advanced(heat, mesh, [60.0, 60.0]).iterations <= 8
    assert heat.totals()["energy_error"] < 1e-9


@pytest.mark.ranks
def test_without_the_columns_the_solid_fraction_slows_newton(comm, monkeypatch):
    """What the correction of the step is for."""
    mesh = cylinder(comm)
    corrected, plain = (problem_under_law(mesh, *LAWS["solid-fraction"]) for _ in range(2))
    full = advanced(corrected, mesh, [20.0]).iterations
    monkeypatch.setattr("castx.heat.newton.couple_step", lambda columns, y, solver: None)
    assert advanced(plain, mesh, [20.0]).iterations > full + 2


@pytest.mark.ranks
def test_full_newton_steps_alone_can_run_in_a_cycle(comm, monkeypatch):
    """A melt in contact with sand at α Δt/h² = 4200: see `castx.heat.newton`."""
    sizes = {"length": 0.02, "mould_length": 0.02, "width": 5e-4, "size": 5e-4}
    description = {"model": "plane-strain", "generator": "two_slabs", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting", "mould"], comm)
    sand = {"density": 1600.0, "heat_capacity": 1100.0, "conductivity": 0.6}

    def solidify() -> None:
        bodies = [
            HeatBody("casting", material(ALUMINIUM), 700.0),
            HeatBody("mould", material(sand), 20.0),
        ]
        pairs = node_pairs(mesh, "casting", "mould")
        heat = HeatProblem(mesh, bodies, [HeatExchange("casting/mould", pairs, "perfect")])
        for k in range(5):
            heat.advance(16.0 * k, 16.0, [None])
            heat.commit()

    solidify()
    monkeypatch.setattr("castx.heat.newton.FULL_STEPS", 1000)
    with pytest.raises(ConvergenceError, match="max it"):
        solidify()


@pytest.mark.serial
def test_automatic_options_follow_the_size_and_keep_the_full_step():
    small, large = (default_options("automatic", n, 3) for n in (2_000, 2_001))
    assert (small["pc_type"], large["ksp_type"]) == ("lu", "gmres")
    assert default_options("iterative", 1, 2)["pc_type"] == "bjacobi"
    assert default_options("direct", 10**9, 3)["ksp_type"] == "preonly"
    # A search for a smaller residual would stop a moving front.
    assert {o["snes_linesearch_type"] for o in (small, large)} == {"basic"}


def test_the_iteration_ends_by_the_heat_that_is_moved(comm):
    balance = balance_under_law(cylinder(comm, size=8e-3), SERIES)
    unknowns, reasons = balance.unknowns, PETSc.SNES.ConvergedReason
    x = balance.layout.create_vector()
    x.array[:] = balance.begin(unknowns.enthalpies(), unknowns.enthalpies(), 1.0, 1.0)
    residual(balance, None, x, balance.residual)
    sums = balance.sums()
    share = sums.residual / sums.moved
    for tolerance, expected in ((1.01 * share, reasons.CONVERGED_FNORM_ABS),
                                (0.99 * share, reasons.ITERATING)):  # fmt: skip
        assert converged(balance, tolerance, False, None, 1, (0.0, 0.0, 1.0)) == expected
    assert converged(balance, 1.0, False, None, 1, (0.0, 0.0, np.nan)) == compat.not_finite()


def test_linear_solves_are_only_as_exact_as_the_goal_needs(comm):
    """A fifth of their iterations is saved, and none of Newton's is lost; a given rtol is kept."""
    mesh = cylinder(comm, model="3d", size=5e-3)
    exact = {"ksp_rtol": FINEST_LINEAR}
    found = []
    for options in (None, exact):
        heat = problem_under_law(mesh, SERIES, tolerance=1e-6, linear="iterative", options=options)
        reports = [advanced(heat, mesh, [1.0]), advanced(heat, mesh, [5.0], substeps=4)]
        newton, linear = (
            sum(getattr(report, name) for report in reports)
            for name in ("iterations", "linear_iterations")
        )
        found.append((newton, linear, state_of(heat)))
        assert heat.totals()["energy_error"] < 1e-6
    (newton, linear, state), (exact_newton, exact_linear, reference) = found
    assert newton <= exact_newton
    assert linear < 0.85 * exact_linear
    assert largest(comm, state - reference) < 1e-3


def test_inexact_linear_solves_do_not_move_a_tight_answer(comm):
    mesh = cylinder(comm, model="3d", size=8e-3)
    states = []
    for linear, tolerance in (("iterative", 1e-11), ("direct", 1e-13)):
        heat = problem_under_law(mesh, SERIES, tolerance=tolerance, linear=linear)
        advanced(heat, mesh, [1.0, 5.0], substeps=2)
        states.append(state_of(heat))
    assert largest(comm, states[0] - states[1]) < 1e-6
