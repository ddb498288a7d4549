"""Block-iterative contact: the penalty solution in turn from bodies or interface and interiors."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.newton import Newton
from castx.errors import ConvergenceError
from tests.coupled_cases import final_state
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    gaps,
    motion,
    pressures,
    problem,
)

SOFT, STIFF = (1e9, 0.3), (1e10, 0.3)


def pressed(comm, method="block-iterative", size=0.005, **settings):
    """Return two blocks, the upper one pressed down on a wider base, and the report."""
    contact = {name: settings.pop(name) for name in list(settings) if name in CONTACT}
    bodies = {"upper": body(elastic(*SOFT)), "base": body(elastic(*STIFF))}
    held = {"base": [fixed("bottom")], "upper": [fixed("top", value=-1e-4)]}
    mesh = blocks(comm, base=(0.04, 0.02), size=size)
    chosen = Contact("upper", "base", method, settings=contact)
    made = problem(mesh, bodies, held, [chosen], **settings)
    return made, made.equilibrium.solve(0.0)


CONTACT = ("penalty", "blocks", "block_solver", "block_iterations")


@pytest.mark.parametrize("linear", ["direct", "iterative"])
@pytest.mark.parametrize("block_solver", ["iteration", "preconditioner"])
@pytest.mark.parametrize("form", ["bodies", "interface"])
def test_every_form_ends_at_the_penalty_solution(comm, form, block_solver, linear):
    expected = pressed(comm, "penalty", penalty=1e12)[0]
    made, report = pressed(
        comm, penalty=1e12, blocks=form, block_solver=block_solver, block_iterations=1000,
        linear=linear, tolerance=1e-10,
    )  # fmt: skip
    assert report.balanced
    assert bool(report.sweeps) == (block_solver == "iteration")
    p = pressures(comm, expected)
    np.testing.assert_allclose(pressures(comm, made), p, atol=1e-6 * p.max())
    np.testing.assert_allclose(gaps(comm, made), gaps(comm, expected), atol=1e-12)
    for name in made.bodies:
        u = everywhere(comm, motion(expected, name)[:, :2])
        found = everywhere(comm, motion(made, name)[:, :2])
        np.testing.assert_allclose(found, u, atol=1e-6 * np.abs(u).max())


def sweeps(comm, **changes) -> int:
    report = pressed(comm, tolerance=1e-3, block_iterations=1000, **changes)[1]
    assert report.balanced
    return len(report.sweeps)


@pytest.mark.serial
def test_sweeps_over_bodies_depend_on_the_penalty_and_not_on_the_mesh(comm):
    """Each sweep leaves the share ε/(ε + k) of the error, k the stiffness of the bodies."""
    soft, hard, fine = (
        sweeps(comm, penalty=penalty, size=size)
        for penalty, size in ((1e12, 0.005), (1e13, 0.005), (1e13, 0.0025))
    )
    assert hard > 5 * soft > 5
    assert fine == pytest.approx(hard, rel=0.2)


@pytest.mark.serial
def test_sweeps_over_interface_and_interiors_depend_on_the_mesh_and_not_on_the_penalty(comm):
    """The literal reading of the paper's system: errors pass from node to node."""
    soft, hard, fine = (
        sweeps(comm, penalty=penalty, size=size, blocks="interface")
        for penalty, size in ((1e12, 0.005), (1e13, 0.005), (1e13, 0.0025))
    )
    assert hard == pytest.approx(soft, rel=0.3)
    assert fine > 1.4 * hard


@pytest.mark.parametrize("form", ["bodies", "interface"])
def test_an_early_stop_leaves_a_state_to_go_on_from(comm, form):
    """Its residual shrinks from sweep to sweep, and the next solve starts where this one ended."""
    made, report = pressed(comm, penalty=1e13, blocks=form, block_iterations=6, tolerance=1e-6)
    assert not report.balanced
    assert len(report.sweeps) == 6
    ends = [report.residuals[place - 1] for place in report.sweeps[1:]] + [report.residuals[-1]]
    assert ends[-1] < 0.9 * ends[0]
    made.equilibrium.commit()
    before = report.residuals[-1]
    following = made.equilibrium.solve(1.0)
    assert following.residuals[0] <= before * (1 + 1e-9)
    assert following.residuals[-1] < before


@pytest.mark.ranks
@pytest.mark.parametrize("form", ["bodies", "interface"])
def test_a_block_without_an_equilibrium_leaves_the_start_to_all_together(comm, form, monkeypatch):
    """Bodies beside others at rest may have none; the solution of the penalty method is found."""
    expected = pressed(comm, "penalty", penalty=1e12, tolerance=1e-10)[0]
    solve, calls = Newton.solve, []

    def failing(newton, x, part=0):
        report = solve(newton, x, part)
        calls.append(part)
        if len(calls) == 4:
            raise ConvergenceError("no equilibrium", "the mechanical equilibrium")
        return report

    monkeypatch.setattr(Newton, "solve", failing)
    made, report = pressed(comm, penalty=1e12, blocks=form, tolerance=1e-10)
    assert not report.balanced and report.iterations > 0
    assert len(calls) == 4 and not made.equilibrium.x.array_r.any()
    made.equilibrium.finish(0.0)
    p = pressures(comm, expected)
    np.testing.assert_allclose(pressures(comm, made), p, atol=1e-6 * p.max())


@pytest.mark.ranks
def test_each_block_ends_quadratically(comm):
    """Within a block Newton's method is exact for elastic bodies once its pairs are known."""
    _, report = pressed(comm, penalty=1e12, tolerance=1e-8, block_iterations=3)
    first = report.residuals[report.sweeps[1] : report.sweeps[2]]
    assert min(first) < 1e-6 * first[0]


def test_a_casting_that_floats_in_a_rigid_mould(comm):
    """Its one body is solved as with the method "rigid", up to the penetration of the penalty."""
    found = []
    for method in ("block-iterative", "rigid"):
        data = {
            "geometry": {"generator": "box_in_mould", "model": "generalised-plane-strain",
                         "box": [0.018, 0.009], "wall": 0.009, "size": 0.0015},
            "bodies": [
                {"name": "casting", "material": "AlSi7Mg", "temperature": 730.0},
                {"name": "mould", "material": "sand-silica", "law": "rigid", "temperature": 86.0},
            ],
            "interfaces": [{"bodies": ["casting", "mould"], "contact": {"method": method},
                            "heat": {"law": "constant", "closed": 2e4}}],
            "boundaries": [{"on": "mould/outside", "heat": {
                "type": "convection", "coefficient": 900.0, "ambient": 25.0}}],
            "loads": {"gravity": [0.0, -9.81]},
            "time": {"end": 200.0, "first_step": 2.0, "largest_step": 20.0,
                     "temperature_change": 100.0},
        }  # fmt: skip
        found.append(final_state(comm, data).totals)
    swept, exact = found
    assert exact["casting/mould.closed_fraction"] < 0.5
    gap = exact["casting/mould.mean_gap"]
    assert gap > 1e-5
    assert swept["casting/mould.mean_gap"] == pytest.approx(gap, rel=0.01)
    weight = exact["casting/mould.force.y"]
    assert weight > 1.0
    assert swept["casting/mould.force.y"] == pytest.approx(weight, rel=1e-3)


@pytest.mark.parametrize("form", ["bodies", "interface"])
def test_what_an_early_stop_leaves_is_balanced_by_all_blocks_together(comm, form):
    """On any number of ranks, and it is the penalty solution."""
    expected = pressed(comm, "penalty", penalty=1e13)[0]
    made, report = pressed(comm, penalty=1e13, blocks=form, block_iterations=2, tolerance=1e-10)
    assert not report.balanced
    assert made.equilibrium.finish(0.0).balanced
    p = pressures(comm, expected)
    np.testing.assert_allclose(pressures(comm, made), p, atol=1e-6 * p.max())


@pytest.mark.serial
@pytest.mark.parametrize("form", ["bodies", "interface"])
def test_a_step_that_sweeps_cannot_balance_is_ended_by_all_blocks_together(comm, form):
    """Under a lid all walls hold the casting, and its weight reaches the floor all the same."""
    found = []
    swept = {"method": "block-iterative", "blocks": form, "block_iterations": 20}
    for contact in (swept, {"method": "penalty"}):
        data = {
            "geometry": {"generator": "box_in_mould", "model": "plane-strain", "lid": True,
                         "box": [0.072, 0.054], "wall": 0.054, "size": 0.009,
                         "cells": "quadrilaterals"},
            "bodies": [
                {"name": "casting", "material": "GJL-250", "temperature": 1270.0},
                {"name": "mould", "material": "steel-H13", "temperature": 150.0},
            ],
            "interfaces": [{"bodies": ["casting", "mould"], "contact": contact,
                            "heat": {"law": "limited", "closed": 7730.0,
                                     "gas_conductivity": 0.05}}],
            "boundaries": [{"on": "mould/base", "displacement": {"normal": 0.0}}],
            "loads": {"gravity": [0.0, -9.81]},
            "time": {"end": 0.02, "fixed_step": 0.01},
        }  # fmt: skip
        found.append(final_state(comm, data))
    swept, exact = found
    assert swept.counters.unbalanced >= 1
    assert swept.totals["casting.force_error"] <= 1e-3
    weight = 7200.0 * 9.81 * 0.072 * 0.054
    assert swept.totals["casting/mould.force.y"] == pytest.approx(weight, rel=1e-3)
    p = exact.paired("casting/mould", "contact_pressure")
    np.testing.assert_allclose(
        swept.paired("casting/mould", "contact_pressure"), p, atol=1e-3 * p.max(initial=0.0)
    )
