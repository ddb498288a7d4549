"""V20: an aluminium cylinder solidifies in a steel mould, after Chiumenti, section 10.2.

670 °C in 200 °C, 2300 W/m²/K as long as they touch, insulated outside, thermo-elastic bodies;
dimensions and materials are ours, so there are no digits of the paper to meet. Shown are the facts
that it describes, the agreement of the section with the quarter in space, of the two contact
methods, of large with small steps, and the effect of a viscous liquid core.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from tests.contact_methods import EXACT
from tests.coupled_cases import (
    TIGHT,
    cylinder,
    fields,
    final_state,
    largest_difference,
    merged,
    pair_value_at,
    places,
    states,
    value_at,
)

INTERFACE = "casting/mould"
RADIUS, OUTSIDE = 0.03, 0.055
SLICE = {"size": 0.005, "interface_size": 0.002, "height": 0.02}
MIDDLE = 0.01
FINE = {"size": 0.004, "interface_size": 0.001, "height": 0.008}
VISCOUS = {
    "materials": {"aluminium": {"liquid": {"model": "viscous", "viscosity": 1e6, "coherency": 0.7}}}
}


def mean_round(state, field: str, body: str, radius: float, height: float) -> float:
    """Return the mean of a nodal field over the circle of nodes at a radius and a height."""
    points = places(state, body)
    r = np.linalg.norm(points[:, :-1], axis=1)
    there = (np.abs(r - radius) < 1e-9) & (np.abs(points[:, -1] - height) < 1e-9)
    # The ends of a quarter stand for half as much of it.
    weights = there * np.where(np.abs(points[:, :-1]).min(axis=1) < 1e-9, 1.0, 2.0)
    sums = np.array([weights.sum(), weights @ state.nodal(body, field)[: len(points)]])
    total = state.mesh.comm.allreduce(sums)
    return float(total[1] / total[0])


def mean_gap(state, height: float) -> float:
    """Return the mean gap of the pairs at a height [m]."""
    pairs = state.pairs[INTERFACE]
    areas = pairs.areas * (np.abs(pairs.points[:, -1] - height) < 1e-9)
    total = state.mesh.comm.allreduce(
        np.array([areas.sum(), areas @ state.paired(INTERFACE, "gap")])
    )
    return float(total[1] / total[0])


def history(comm, data, height: float = MIDDLE) -> np.ndarray:
    """Return time, centre and face of the casting, face and outside of the mould, gap [µm], f_s."""
    return np.array(
        [
            [
                state.time,
                mean_round(state, "temperature", "casting", 0.0, height),
                mean_round(state, "temperature", "casting", RADIUS, height),
                mean_round(state, "temperature", "mould", RADIUS, height),
                mean_round(state, "temperature", "mould", OUTSIDE, height),
                1e6 * mean_gap(state, height),
                state.totals["casting.solid_fraction"],
            ]
            for state in states(comm, data)
        ]
    )


def check_agreement(found, reference, temperature: float, gap: float, smallest: float) -> None:
    """Compare histories at the times of `found`: K, share of the gap, µm."""
    at = np.array([np.interp(found[:, 0], reference[:, 0], c) for c in reference.T]).T
    assert np.abs(found - at)[:, 1:5].max() < temperature
    excess = np.abs(found - at)[:, 5] - np.maximum(gap * at[:, 5], smallest)
    assert excess.max() < 0


@pytest.mark.ranks
def test_section_and_quarter_agree(comm):
    """At the same element size 2 K, and 3 % or 1 µm of the gap, over the circle of the interface.

    The face of the casting leaves its melting point node by node as the front passes: a staircase
    of a height that falls with the element size, hence fine elements there.
    """
    steps = {"time": {"end": 10.0, "fixed_step": 1.0}}
    section = history(comm, cylinder(steps, **FINE), 0.004)
    quarter = history(comm, cylinder(steps, model="3d", sector="quarter", **FINE), 0.004)
    check_agreement(quarter, section, 2.0, 0.03, 1.0)
    assert section[-1, 5] > 10.0
    assert section[-1, 6] == pytest.approx(quarter[-1, 6], abs=0.01)


def test_facts(comm):
    """The mould moves at once, the casting later, the gap grows, heat slows, none is lost."""
    data = cylinder({"time": {"end": 40.0}}, **SLICE)
    gaps, mould, casting, heat, times = [], [], [], [], []
    for state in states(comm, data):
        times.append(state.time)
        gaps.append(mean_gap(state, MIDDLE))
        mould.append(value_at(state, "mould", "displacement", RADIUS, MIDDLE)[0])
        casting.append(value_at(state, "casting", "displacement", RADIUS, MIDDLE)[0])
        heat.append(state.totals[f"{INTERFACE}.heat"])
        assert state.totals["energy_error"] < 1e-6
        assert state.totals["support_force"] == 0.0
        assert state.paired(INTERFACE, "gap").min(initial=0.0) >= -1e-12
    assert mould[1] > 0
    early = np.array(times) < 0.7
    assert (np.diff(np.array(mould)[early]) > 0).all()
    assert np.abs(np.array(casting)[early]).max() < 0.1 * np.array(mould)[early].max()
    assert casting[-1] < -10e-6
    assert (np.diff(gaps) > -1e-7).all()
    assert gaps[-1] > 20e-6
    flow = np.diff(heat) / np.diff(times)
    assert flow[-1] < 0.4 * flow[0]


LONG = merged(
    TIGHT,
    {
        "solver": {"mechanics_tolerance": 1e-13},
        "time": {"end": 90.0, "largest_step": 5.0},
        "output": {"every": 10.0},
    },
)


@pytest.mark.slow
@pytest.mark.serial
@pytest.mark.parametrize("liquid", [{}, VISCOUS], ids=["elastic", "viscous"])
def test_methods_agree_over_the_whole_run(comm, liquid):
    """Multipliers and condensed contact: the same steps, all fields to 1e-8 at each."""
    runs = [
        [(state.time, fields(state)) for state in states(comm, case)]
        for case in (cylinder(LONG, liquid, method=m, size=0.0075) for m in EXACT)
    ]
    assert len(runs[0]) == len(runs[1]) > 30
    for (time, one), (other_time, other) in zip(*runs, strict=True):
        assert time == pytest.approx(other_time, rel=1e-8)
        difference, where = largest_difference(one, other)
        assert difference < 1e-8, (time, where)


@pytest.mark.parametrize("end", [10.0, 20.0])
def test_viscous_core(comm, end):
    """The liquid follows its mould outwards; then the shell shrinks as nothing else holds it.

    Reference: contraction of a free shell that grows, α R ∫ Σ r w dT/Σ r w over its nodes, from the
    place of the wall that it has left. An elastic melt props the shell, so that its gap is smaller.
    """
    followed = contraction = free = gap = 0.0
    last: tuple[Any, Any] | None = None
    for state in states(comm, cylinder({"time": {"end": end}}, VISCOUS)):
        gap = pair_value_at(state, INTERFACE, "gap", (RADIUS, 0.03))
        wall, skin = (
            float(value_at(state, body, "displacement", RADIUS, 0.03)[0])
            for body in ("mould", "casting")
        )
        points = places(state, "casting")
        layer = np.abs(points[:, 1] - 0.03) < 1e-6
        share = state.nodal("casting", "solid_fraction")[: len(points)][layer]
        temperature = np.minimum(state.nodal("casting", "temperature")[: len(points)][layer], 660.0)
        if last is not None and gap >= 1e-12:
            weight = points[layer, 0] * 0.5 * (share + last[0])
            cooled, bearing = comm.allreduce(
                np.array([weight @ (last[1] - temperature), weight.sum()])
            )
            free += RADIUS * 2.4e-5 * cooled / bearing
        last = share, temperature
        if gap < 1e-12:
            assert skin == pytest.approx(wall, abs=1e-12)
            followed = wall
        contraction = followed - skin
    assert followed > 1e-6
    assert contraction == pytest.approx(free, rel=0.3)
    elastic = final_state(comm, cylinder({"time": {"end": end}}))
    propped = pair_value_at(elastic, INTERFACE, "gap", (RADIUS, 0.03))
    assert 0.6 * gap < propped < 0.9 * gap


@pytest.fixture(scope="module")
def small_steps():
    return history(MPI.COMM_SELF, cylinder({"time": {"end": 60.0, "fixed_step": 0.1}}, **SLICE))


@pytest.mark.slow
@pytest.mark.serial  # long, and of one rank's concern
@pytest.mark.parametrize("steps", [{"fixed_step": 5.0}, {"largest_step": 5.0}])
def test_large_steps(comm, small_steps, steps):
    """Steps up to 5 s against 0.1 s: 10 K and 8 %, the end of freezing by 2 % or half a step."""
    found = history(comm, cylinder({"time": {"end": 60.0, **steps}}, **SLICE))
    assert np.diff(found[:, 0]).max() > 2.4
    check_agreement(found[1:], small_steps, 10.0, 0.08, 1.0)
    solid = [np.interp(0.98, run[:, 6], run[:, 0]) for run in (found, small_steps)]
    assert solid[0] == pytest.approx(solid[1], rel=0.02, abs=2.5)
