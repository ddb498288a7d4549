"""Newton's method on two bars whose answer is known, and what it reports."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.newton import enough_of_linear
from castx.errors import ConvergenceError
from tests.contact_methods import EXACT, IN_THE_LIMIT
from tests.coupled_cases import cylinder, states
from tests.elastic_bodies import blocks, body, elastic, fixed, gaps, pressures, problem

LENGTH, SQUEEZE, YOUNG = 0.02, 2e-5, {"upper": 7e9, "base": 70e9}


def bars(comm, method="condensed", **settings):
    """Return two bars without lateral strain, of one cell in width, squeezed by 20 µm."""
    mesh = blocks(comm, upper=(0.02, LENGTH), base=(0.02, LENGTH), size=LENGTH)
    bodies = {name: body(elastic(E, 0.0)) for name, E in YOUNG.items()}
    held = {"base": [fixed("bottom")], "upper": [fixed("top", value=-SQUEEZE)]}
    contact = Contact("upper", "base", method, lambda x: np.full(len(x), 5e-6))
    return problem(mesh, bodies, held, [contact], **settings)


@pytest.mark.serial
@pytest.mark.parametrize("method", IN_THE_LIMIT)
def test_two_bars(comm, method):
    """An open pair closes, p = (d - g0)/(L/E1 + L/E2); one linear problem for each set."""
    made = bars(comm, method)
    report = made.equilibrium.solve(0.0)
    exact = (SQUEEZE - 5e-6) / sum(LENGTH / E for E in YOUNG.values())
    np.testing.assert_allclose(pressures(comm, made), exact, rtol=1e-9)
    np.testing.assert_allclose(gaps(comm, made), 0.0, atol=1e-12)
    assert report.contact_changes == 2 and report.balanced
    assert report.iterations == 2 + len(report.augmentations)
    assert len(report.residuals) == report.iterations + 1 + len(report.augmentations)
    assert report.linear_iterations == sum(report.linear_solves)


@pytest.mark.serial
def test_a_report_says_whether_anything_had_to_move(comm):
    made = bars(comm)
    assert not made.equilibrium.solve(0.0).began_balanced
    assert made.equilibrium.solve(0.0).began_balanced
    made.equilibrium.x.array[:] *= 1.0 + 1e-9  # beyond rounding, not beyond the tolerance
    assert not made.equilibrium.solve(0.0).began_balanced


@pytest.mark.serial
def test_bodies_a_billion_times_as_soft_take_the_same_iterations(comm):
    """Their forces are millinewtons, and no tolerance knows a newton."""
    reports = []
    for factor in (1.0, 1e-9):
        bodies = {name: body(elastic(factor * E, 0.3)) for name, E in YOUNG.items()}
        held = {"base": [fixed("bottom")], "upper": [fixed("top", value=-SQUEEZE)]}
        mesh = blocks(comm, upper=(0.02, LENGTH), base=(0.03, LENGTH), size=0.002)
        made = problem(mesh, bodies, held, [Contact("upper", "base")], linear="multigrid")
        reports.append(made.equilibrium.solve(0.0))
    assert reports[0].linear_solves == reports[1].linear_solves
    assert min(reports[0].linear_solves) > 3


@pytest.mark.serial
def test_a_failure_says_where_the_residual_is_largest(comm):
    made = bars(comm, options={"snes_max_it": 1})
    with pytest.raises(ConvergenceError, match=r"did not converge.*body '(upper|base)'"):
        made.equilibrium.solve(0.0)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("norm", "left"), [(1e-1, 1e-6), (1.0, 1e-4), (1e2, 1e-2), (1e4, 1.0), (1e8, 1.0)]
)
def test_linear_solves_see_forces_beside_the_rows_of_pairs_that_close(norm, left):
    """The square of a small residual; of a large one a part, and of forces of 10 kN no more."""
    assert enough_of_linear(norm, 1e4) == pytest.approx(left)


@pytest.mark.ranks
@pytest.mark.sampled
@pytest.mark.parametrize("method", ["condensed", "multipliers"])
def test_a_pair_that_opens_while_a_skin_creeps_does_not_hold_the_iteration_up(comm, method):
    """Nine pairs of twenty open in one step of ten iterations at most, and none returns."""
    data = {
        "geometry": {"generator": "cylinder_in_mould", "model": "axisymmetric", "radius": 0.04,
                     "height": 0.06, "wall": 0.06, "floor": 0.03, "size": 0.0075},
        "materials": {"iron": {"extends": "GJS-400", "law": "garofalo", "creep_rate": 1e9,
                               "breakdown_stress": 25e6, "exponent": 5.0,
                               "activation_energy": 150e3}},
        "bodies": [
            {"name": "casting", "material": "iron", "temperature": 1203.0, "freezing": "nodes",
             "law": "thermo-elasto-viscoplastic"},
            {"name": "mould", "material": "steel-carbon", "temperature": 150.0},
        ],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "contact": {"method": method, "normals": "averaged"},
                        "heat": {"law": "limited", "closed": 200.0, "gas_conductivity": 0.05}}],
        "boundaries": [{"on": "mould/base", "displacement": {"normal": 0.0}}],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 100.0, "fixed_step": 20.0},
    }  # fmt: skip
    opened = 0
    for state in states(comm, data):
        counters = state.counters
        opened += counters.contact_changes
        assert counters.cutbacks == 0 and counters.mechanics_iterations <= 10
        gap = state.totals["casting/mould.mean_gap"]
    assert opened == 15
    assert gap == pytest.approx(2.0562e-5, rel=1e-3)


@pytest.mark.ranks
@pytest.mark.sampled
@pytest.mark.parametrize("method", ["condensed", "multipliers"])
def test_a_skin_leaves_the_wall_while_it_comes_into_balance(comm, method):
    """Not one ring of pairs after the other, each once all flow has settled."""
    data = cylinder(
        {"bodies": [{"name": "casting", "material": "Al-pure", "temperature": 670.0,
                     "law": "thermo-elasto-viscoplastic"},
                    {"name": "mould", "material": "steel-H13", "temperature": 200.0}],
         "time": {"end": 5.8}},
        method=method, height=0.1, size=0.0025,
    )  # fmt: skip
    opening = [state.counters for state in states(comm, data) if state.counters.contact_changes]
    assert sum(counters.contact_changes for counters in opening) > 20
    assert all(counters.cutbacks == 0 for counters in opening)
    assert max(counters.mechanics_iterations for counters in opening) <= 10


@pytest.mark.sampled
@pytest.mark.parametrize("method", EXACT)
def test_pairs_that_close_do_not_take_metal_that_yields_along_at_once(comm, method):
    """Steps go as far as forces do, so that few pairs close that would open again."""
    liquid = {"model": "norton", "coherency": 0.95, "coefficient": 1.12e-11, "exponent": 2.0}
    data = {
        "geometry": {"generator": "box_in_mould", "model": "plane-strain", "wall": 0.275,
                     "box": [0.472, 0.316], "size": 0.1, "cells": "quadrilaterals"},
        "materials": {"alloy": {"extends": "AlSi7Mg", "liquid": liquid}},
        "bodies": [
            {"name": "casting", "material": "alloy", "temperature": 681.0,
             "law": "thermo-elasto-plastic"},
            {"name": "mould", "material": "Cu-pure", "temperature": 150.0},
        ],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": {"method": method},
                        "heat": {"law": "limited", "closed": 3700.0, "gas_conductivity": 0.045}}],
        "boundaries": [{"on": "mould/base", "displacement": {"normal": 0.0}}],
        "time": {"end": 60.0, "fixed_step": 4.0},
    }  # fmt: skip
    counters = [state.counters for state in states(comm, data)]
    for step in counters[-3:]:
        assert step.cutbacks == 0
        assert step.contact_changes <= 20 and step.mechanics_iterations <= 30
