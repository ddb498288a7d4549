"""Convergence: each body by its own forces, and where a residual is largest."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.reading.read import load_case
from castx.contact.choice import Contact
from castx.equilibrium.convergence import ForceConvergence, standstill, worst_row
from castx.equilibrium.net_forces import NetForces
from castx.process.simulation import Simulation
from tests.elastic_bodies import blocks, body, elastic, fixed, problem
from tests.small_contact import STIFF, two_blocks


def limits_of(made, tolerance: float) -> ForceConvergence:
    balance = made.equilibrium.balance
    net = NetForces(balance.assembly, balance.transform, balance.gaps)
    return ForceConvergence(balance.assembly, balance.contact.layout, net, tolerance)


def without_rounding(limits: ForceConvergence, made, pair_forces=None) -> None:
    size = made.equilibrium.x.getLocalSize()
    limits.begin(np.zeros(size))
    none = np.zeros(len(made.gaps.local))
    given = none if pair_forces is None else pair_forces
    limits.update(made.equilibrium.x, np.zeros(size), given)


@pytest.mark.ranks
def test_each_body_is_measured_by_the_forces_on_it(comm):
    made = two_blocks(comm)
    limits = limits_of(made, 1e-3)
    _, forces = made.pair_values()
    without_rounding(limits, made, forces)
    top, side = 1e6 * 0.02, 2e5 * 0.03
    assert np.hypot(top, side) < limits.acting[0] < top + 2 * side
    # Nothing acts on the base but the upper block.
    assert limits.acting[1] == pytest.approx(comm.allreduce(forces.sum()), rel=1e-12)
    assert limits.smallest == pytest.approx(1e-3 * limits.acting.min(), rel=1e-12)
    f = made.equilibrium.x.duplicate()
    for b, force in enumerate(limits.acting):
        part = made.layout.local_slice(b)
        for share, met in ((0.99e-3, True), (1.01e-3, False)):
            f.set(0.0)
            if comm.rank == comm.size - 1:
                # A row of pressure, so that nothing is left of the resultant.
                f.array[part.start + 2] = share * force
            assert limits.is_met(f) == met


def test_internal_forces_measure_a_body_on_which_nothing_acts(comm):
    mesh = blocks(comm, symmetry=False, size=0.01)
    bodies = {"upper": body(elastic(*STIFF)), "base": body(elastic(*STIFF))}
    held = {
        "base": [fixed("bottom", "all")],
        "upper": [fixed("top", "y", value=1e-5), fixed("side", "x")],
    }
    made = problem(mesh, bodies, held, [Contact("upper", "base", "condensed")])
    made.equilibrium.solve(0.0)
    limits = limits_of(made, 1e-3)
    without_rounding(limits, made)
    internal = made.equilibrium.balance.assembly.force_scales()
    np.testing.assert_allclose(limits.acting, np.maximum(internal, 1e-4 * internal.max()))


def test_net_forces_far_below_the_internal_ones_are_not_resolved(comm):
    made = two_blocks(comm)
    limits = limits_of(made, 1e-3)
    forces = np.full(len(made.gaps.local), 1e-9)
    without_rounding(limits, made, forces)
    internal = made.equilibrium.balance.assembly.force_scales()
    assert limits.acting[1] == pytest.approx(1e-7 * internal[1], rel=1e-12)


def test_a_weight_of_a_millionth_of_the_internal_forces_is_resolved(comm):
    """Hot castings weigh no more."""
    made = two_blocks(comm)
    limits = limits_of(made, 1e-3)
    internal = made.equilibrium.balance.assembly.force_scales()
    pairs = comm.allreduce(len(made.gaps.local))
    without_rounding(limits, made, np.full(len(made.gaps.local), 1e-6 * internal[1] / pairs))
    assert limits.acting[1] == pytest.approx(1e-6 * internal[1], rel=1e-12)


def test_a_resultant_counts_though_each_of_its_forces_is_small(comm):
    """A hundred forces of a thousandth part each are a tenth in sum, a hundredth as a norm."""
    made = two_blocks(comm)
    balance, f = made.equilibrium.balance, made.equilibrium.x.duplicate()
    limits = limits_of(made, 0.02)
    _, forces = made.pair_values()
    without_rounding(limits, made, forces)
    part, size = made.layout.local_slice(0), balance.assembly.bodies[0].block_size
    rows = np.zeros(part.stop - part.start).reshape(-1, size)
    nodes = comm.allreduce(len(rows))
    rows[:, 1] = 0.04 * limits.acting[0] / nodes
    nodal = np.zeros(made.layout.size_local)
    nodal[part] = rows.ravel()
    f.array[:] = balance.transform.forces_on_unknowns(nodal)
    assert not limits.is_met(f)
    assert limits.errors[0] == pytest.approx(0.04, rel=1e-9)
    f.scale(0.4)
    assert limits.is_met(f)


def test_rounding_of_what_cancels_is_no_residual(comm):
    """Terms of a row that are 10¹⁴ times the forces leave more than the tolerance."""
    made = two_blocks(comm)
    x = made.equilibrium.x
    limits = limits_of(made, 1e-12)
    none, nothing = np.zeros(x.getLocalSize()), np.zeros(len(made.gaps.local))
    without_rounding(limits, made)
    strict = limits.smallest
    limits.update(x, np.full(x.getLocalSize(), 1e22), nothing)
    assert limits.smallest > 10 * strict
    # What acts at the start of a solution counts to its end.
    loose = limits.smallest
    limits.update(x, np.full(x.getLocalSize(), 1e20), nothing)
    assert limits.smallest >= 0.9 * strict
    limits.begin(none)
    limits.update(x, none, nothing)
    assert limits.smallest == strict < loose


def test_forces_have_a_floor_of_meaning(comm):
    """Bodies without any force would ask for residuals of zero."""
    made = two_blocks(comm)
    size = made.equilibrium.x.getLocalSize()
    limits = limits_of(made, 1e-3)
    limits.begin(np.full(size, 1e9))
    made.equilibrium.x.set(0.0)
    limits.update(made.equilibrium.x, np.zeros(size), np.zeros(len(made.gaps.local)))
    length = max(b.length for b in made.equilibrium.balance.assembly.bodies)
    expected = 2e-14 * 1e-6 * length * 1e9 * np.sqrt(comm.allreduce(size))
    assert limits.rounding == pytest.approx(expected, rel=1e-12)


@pytest.mark.ranks
def test_the_worst_row_has_a_body_and_a_place(comm):
    made = two_blocks(comm)
    balance = made.equilibrium.balance
    f = made.equilibrium.x.duplicate()
    own = made.layout.local_slice(1)
    if comm.rank == comm.size - 1:
        f.array[own.start] = 7.0
    text = worst_row(balance.assembly, balance.gaps, balance.contact.layout, f)
    assert "body 'base' (forces)" in text and "7" in text
    assert len(set(comm.allgather(text))) == 1


@pytest.mark.ranks
def test_rows_of_multipliers_belong_to_their_interface(comm):
    made = two_blocks(comm, "multipliers")
    balance = made.equilibrium.balance
    f = made.equilibrium.x.duplicate()
    if len(made.gaps.local):
        f.array[-1] = 7.0
    text = worst_row(balance.assembly, balance.gaps, balance.contact.layout, f)
    assert "interface 'upper/base'" in text


ROUNDED = [4e3, 2.0, 3e-3, 3.1e-6, 1.5e-6, 3.6e-6, 2.2e-6, 1.9e-6, 2.8e-6, 2.1e-6, 3.3e-6]


@pytest.mark.serial
def test_a_standstill_at_rounding_names_the_tolerance_that_accepts_it():
    text = standstill(ROUNDED, wanted=1e-6, tolerance=1e-6)
    assert "between 1.9e-06 and 3.3e-06 N" in text and "below 1e-06 N" in text
    assert "solver.mechanics_tolerance = 1e-05 accepts it" in text


@pytest.mark.serial
@pytest.mark.parametrize(
    ("residuals", "wanted"),
    [
        (ROUNDED, 1e-9),  # no tolerance up to the usual one would do
        (ROUNDED[:9], 1e-6),  # too few iterates to tell
        ([10.0**-k for k in range(11)], 1e-11),  # it falls
        ([*ROUNDED[:10], np.nan], 1e-6),
    ],
)
def test_what_does_not_stand_still_at_rounding_is_a_failure_of_the_forces(residuals, wanted):
    assert standstill(residuals, wanted, tolerance=1e-6) == ""


@pytest.mark.parametrize(("share", "resolved"), [(1e-6, True), (1e-9, False)])
def test_forces_of_a_millionth_count_and_those_of_a_billionth_do_not(
    comm, monkeypatch, share, resolved
):
    """A hot casting weighs a millionth of its internal forces, and its weight is to balance."""
    made = two_blocks(comm)
    limits = limits_of(made, 1e-3)
    internal = made.equilibrium.balance.assembly.force_scales()
    internal = np.maximum(internal, 1e-4 * internal.max())
    monkeypatch.setattr(limits._net, "acting", lambda forces: share * internal)
    without_rounding(limits, made)
    if resolved:
        np.testing.assert_allclose(limits.acting, share * internal)
    else:
        np.testing.assert_allclose(limits.acting, 1e-7 * internal)


def test_a_shell_round_trapped_liquid_is_solved_to_rounding_where_more_is_asked_for(comm):
    """Nearly incompressible triangles in stress and pressure, elastic, frozen at the wall.

    The residual stands still at rounding, far above the tolerance; without a floor there not one
    step is found.
    """
    case = load_case({
        "geometry": {"generator": "core_in_ring", "model": "plane-strain", "core_radius": 0.02,
                     "outer_radius": 0.03, "size": 0.005},
        "materials": {"stiff": {"extends": "AlSi7Mg", "poisson_ratio": 0.49}},
        "bodies": [
            {"name": "core", "material": "stiff", "temperature": 710, "law": "thermo-elastic"},
            {"name": "casting", "material": "steel-H13", "temperature": 160,
             "formulation": "displacement"},
        ],
        "interfaces": [{"bodies": ["core", "casting"], "heat": {
            "law": "series", "closed": 1200, "gas_conductivity": 0.05}}],
        "solver": {"mechanics_tolerance": 1e-12},
        "time": {"end": 12, "first_step": 0.05, "smallest_step": 0.04},
    })  # fmt: skip
    states = list(Simulation.from_case(case, comm))
    assert states[-1].time == pytest.approx(12.0)
    assert states[0].time == 0.0 and len(states) > 10
