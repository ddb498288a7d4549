"""Margin by the computed suction: what counts, over the column of mush, and goes on."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.foundry.stress.mush_suction import (
    SUCTION_MARGIN,
    LargestSuction,
    SuctionMargins,
    TearingMelt,
    suction_margins_of,
)
from castx.results.states.snapshot import ProcessState
from tests.castx.fakes import FakeSnapshot, cylinder_mesh
from tests.coupled_cases import places, simulation
from tests.verification.mush_strips import CONTRACTION, LENGTH, SPACING, SPEED, VISCOSITY, strip

MELT = TearingMelt(depression=2e3, cut_off=0.02)


@pytest.fixture(scope="module")
def mesh():
    return cylinder_mesh(MPI.COMM_WORLD, size=6e-3)


def snapshot(mesh, solid, stress, **process):
    formulas = {
        "solid_fraction": lambda x: np.full(len(x), solid),
        "pressure": lambda x: np.full(len(x), stress),
    }
    return FakeSnapshot(0.0, 0, mesh, formulas=formulas, process=ProcessState(**process))


def margin(margins, mesh, *course, **process):
    """Return the margin of the casting behind solid fractions and suctions."""
    for solid, stress in course:
        margins.update(snapshot(mesh, solid, stress, **process))
    (found,) = np.unique(margins.field("casting", SUCTION_MARGIN))
    return found


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("course", "expected"),
    [
        ([(0.0, -1e3), (0.5, 1e3), (0.9, 800.0)], 0.5),
        ([(0.5, 0.0), (0.98, 5e3), (0.99, 9e3), (1.0, 9e5)], 2.5),
        ([(0.5, 0.0), (0.95, 5e3), (1.0, 9e3)], 4.5),
        ([(0.5, 0.0), (0.9, 5e3), (0.0, 7e3), (0.4, 1e3)], 0.5),  # melts
        ([(0.9, 5e3)], 0.0),  # the initial state is no step
    ],
)
def test_the_largest_suction_counts_while_melt_is_connected(mesh, course, expected):
    assert margin(SuctionMargins(mesh, {"casting": MELT}), mesh, *course) == expected


def test_depression_and_cut_off_decide(mesh):
    course = [(0.5, 0.0), (0.92, 1e3), (0.98, 4e3)]
    for melt, expected in (
        (MELT, 2.0), (TearingMelt(1e3, 0.02), 4.0), (TearingMelt(2e3, 0.06), 0.5)
    ):  # fmt: skip
        assert margin(SuctionMargins(mesh, {"casting": melt}), mesh, *course) == expected


def test_a_new_body_begins_anew_and_others_have_none(mesh):
    margins = SuctionMargins(mesh, {"casting": MELT})
    assert margin(margins, mesh, (0.5, 0.0), (0.6, 1e3)) == 0.5
    new = {"renewed": frozenset(["casting"])}
    assert margin(margins, mesh, (0.2, 1e3), **new) == 0.0
    assert margins.field("mould", SUCTION_MARGIN) is None
    assert margins.field("casting", "emptied") is None


def test_it_goes_on_as_if_it_had_not_stopped(mesh):
    first, second = (SuctionMargins(mesh, {"casting": MELT}) for _ in range(2))
    margin(first, mesh, (0.5, 0.0), (0.9, 1e3))
    second.restore({name: saved.values for name, saved in first.saved().items()})
    more = [(0.94, 3e3), (1.0, 8e3)]
    assert margin(second, mesh, *more) == margin(first, mesh, *more) == 4.0
    body = LargestSuction(mesh.bodies["casting"], MELT)
    body.restore({name: saved.values for name, saved in body.saved().items()})
    body.update(np.full(len(body.margin), 0.5), np.full(len(body.margin), 9e3))
    assert not body.margin.any()


def test_the_margin_of_a_column_is_its_exact_suction(comm):
    """180 μ v β ΔT/(λ2² G) (1/g + 2 ln g − g) over 2 kPa at g = 0.03; none below g_c = 0.02."""
    step, g = 1e-4, 0.03
    drag = 180 * VISCOSITY * SPEED * CONTRACTION * LENGTH / SPACING**2
    exact = drag * (1 / g + 2 * np.log(g) - g)
    data = strip(
        {"materials": {"alloy": {"coalescence": 0.98}}, "output": {"fields": [SUCTION_MARGIN]}},
        size=LENGTH / 100, step=step, end=step, cooling=10.0, ahead=10.0 * step + 1e-9,
    )  # fmt: skip
    run = simulation(comm, data)
    margins = suction_margins_of(read_case(data, Path("case.toml")), run.mesh)
    for state in run:
        margins.update(state)
        x = places(state, "casting")[:, 0]
    found = margins.field("casting", SUCTION_MARGIN)[: len(x)]
    run.destroy()
    at = np.isclose(x, g * LENGTH)
    below = x < 0.015 * LENGTH
    assert found[at] == pytest.approx(exact / 2e3, rel=0.01) and at.any()
    assert not found[below].any() and below.any()
