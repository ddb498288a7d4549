"""Liquid in a closed shell resists compression, and pores open in it: sphere and cylinder.

The exact answers stand in `closed_shells.py`; elastic, perfectly plastic, viscous and rigid shells.
The shell is solid from the start. Between it and its core lies metal that holds liquid and solid, a
cell wide on each side, so that the answers are right to the first order of its width.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.trapped_liquid import FULL_SHARE
from castx.tables import Table
from tests.verification.closed_shells import (
    BULK,
    INNER,
    KINDS,
    OUTER,
    SHRINKAGE,
    Shell,
    closed_shell,
    freeze,
    outer_motion,
    settle,
)

pytestmark = pytest.mark.sampled

shells = pytest.mark.parametrize("dimension", [3, 2], ids=["sphere", "cylinder"])
kinds = pytest.mark.parametrize("kind", KINDS)
ACROSS = 40
PUSH = 50e6


@shells
@kinds
def test_a_full_core_bears_what_presses_its_elastic_shell(comm, shared_tmp_path, dimension, kind):
    made = closed_shell(
        comm, shared_tmp_path, dimension, kind, ACROSS, pressure=Table.constant(PUSH)
    )
    freeze(made, 0.0)
    found, shell = settle(made, 0.0), Shell(dimension)
    exact = shell.full(PUSH, 0.0)
    assert -found["pocket_pressure"] == pytest.approx(shell.core_pressure(*exact), rel=0.02)
    assert outer_motion(comm, made) == pytest.approx(shell.displacement(*exact, OUTER), rel=0.02)
    assert found["unfed_volume"] == 0.0


@shells
@kinds
def test_half_of_the_size_halves_the_error(comm, shared_tmp_path, dimension, kind):
    """Of the pressure in a full core, in which the front takes up a cell on each side."""
    errors = []
    for across in (20, 40):
        made = closed_shell(
            comm, shared_tmp_path, dimension, kind, across, pressure=Table.constant(PUSH)
        )
        freeze(made, 0.0)
        exact = Shell(dimension).core_pressure(*Shell(dimension).full(PUSH, 0.0))
        errors.append(abs(-settle(made, 0.0)["pocket_pressure"] / exact - 1.0))
    assert errors[1] < 0.6 * errors[0]


@shells
@kinds
def test_pores_open_where_the_shell_is_drawn_apart(comm, shared_tmp_path, dimension, kind):
    """The cavity pressure acts in the core, and the void is what its wall has moved."""
    limit = 20e6
    made = closed_shell(
        comm,
        shared_tmp_path,
        dimension,
        kind,
        ACROSS,
        pressure=Table.constant(-PUSH),
        cavitation=limit,
    )
    freeze(made, 0.0)
    found, shell = settle(made, 0.0), Shell(dimension)
    exact = shell.porous(-PUSH, -limit)
    void = dimension * shell.displacement(*exact, INNER) / INNER * shell.core_volume()
    assert found["pocket_pressure"] == pytest.approx(limit, rel=1e-9)
    assert found["unfed_volume"] == pytest.approx(void, rel=0.02)
    assert outer_motion(comm, made) == pytest.approx(shell.displacement(*exact, OUTER), rel=0.02)


@shells
@kinds
def test_shrinkage_first_unloads_the_core_and_then_leaves_a_void(
    comm, shared_tmp_path, dimension, kind
):
    """Pressed together, the core follows its shrinkage; let go, all of the shrinkage is void."""
    pressure = Table.from_points([[0.0, 0.0], [1.0, 5e9], [2.0, 5e9], [3.0, 0.0], [4.0, 5e9]])
    made = closed_shell(comm, shared_tmp_path, dimension, kind, ACROSS, pressure=pressure)
    shell, volume = Shell(dimension), Shell(dimension).core_volume()
    for time, core in ((1.0, 0.0), (2.0, 0.1)):
        freeze(made, core)
        found = settle(made, time)
        exact = shell.full(5e9, -found["feeding_demand"] / volume)
        assert -found["pocket_pressure"] == pytest.approx(shell.core_pressure(*exact), rel=0.02)
        expected = shell.displacement(*exact, OUTER)
        assert outer_motion(comm, made) == pytest.approx(expected, rel=0.02)
        assert found["unfed_volume"] == 0.0
    assert 0.03 * SHRINKAGE < found["feeding_demand"] / volume < 0.1 * SHRINKAGE
    freeze(made, 0.1)
    found = settle(made, 3.0)
    assert found["unfed_volume"] == pytest.approx(found["feeding_demand"], rel=1e-6)
    assert found["fed_volume"] == found["pocket_pressure"] == 0.0
    assert abs(outer_motion(comm, made)) < 1e-6 * OUTER
    freeze(made, 0.1)
    again = settle(made, 4.0)  # filled before it resists: the answer of time 2 again
    assert again["unfed_volume"] == 0.0
    assert outer_motion(comm, made) == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
@shells
@pytest.mark.parametrize("kind", ["osgs", "q1p0"])
@pytest.mark.parametrize("viscosity", [0.0, 1e9], ids=["plastic", "viscous"])
def test_a_core_that_swells_flows_its_shell(comm, shared_tmp_path, dimension, kind, viscosity):
    """Graphite, by up to 2 % of the volume; σ_Y 30 MPa alone, and with Bingham's viscosity."""
    strength, step, shell = 30e6, 10.0, Shell(dimension)
    flow = {"law": "bingham", "viscosity": viscosity} if viscosity else {}
    law = "thermo-elasto-viscoplastic" if viscosity else "thermo-elasto-plastic"
    made = closed_shell(
        comm, shared_tmp_path, dimension, kind, ACROSS, shell=law, yield_stress=strength,
        solidification_shrinkage=-SHRINKAGE, **flow,
    )  # fmt: skip
    swollen = [0.0]
    for fraction in (0.15, 0.3):
        freeze(made, fraction, step=step)
        found = settle(made, 0.0)
        swollen.append(-found["feeding_demand"] / shell.core_volume())
    exact = shell.flow_pressure(strength, viscosity, (swollen[-1] - swollen[-2]) / step)
    assert swollen[-1] > 0.01
    assert -found["pocket_pressure"] == pytest.approx(exact, rel=0.02)
    moved = shell.flown(swollen[-1], exact)
    assert outer_motion(comm, made) == pytest.approx(moved, rel=0.02)
    assert found["unfed_volume"] == 0.0


@kinds
def test_liquid_in_a_rigid_shell(comm, shared_tmp_path, kind):
    """Nothing but liquid: pressed together it is stiff but not singular, shrinking it is void."""
    motion = Table.from_points([[0.0, 0.0], [1.0, -1e-7], [2.0, 0.0], [3.0, 0.0]])
    made = closed_shell(comm, shared_tmp_path, 3, kind, 6, moved=motion, liquid=2 * OUTER)
    pressed = 3e-7 / OUTER
    freeze(made, 0.0, size=2 * OUTER)
    assert not made.bodies["casting"].coherent.any()
    found = settle(made, 1.0)
    assert -found["pocket_pressure"] == pytest.approx(pressed * BULK / FULL_SHARE, rel=0.01)
    for time, fraction in ((2.0, 0.2), (3.0, 0.8)):
        freeze(made, fraction, size=2 * OUTER)
        found = settle(made, time)
        whole = SHRINKAGE * fraction * 2 / 3 * np.pi * OUTER**3
        assert found["unfed_volume"] == pytest.approx(found["feeding_demand"], rel=1e-9)
        assert found["feeding_demand"] == pytest.approx(whole, rel=0.01)
        assert found["pocket_pressure"] == 0.0
