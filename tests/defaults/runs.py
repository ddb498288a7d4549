"""Cases run as a user runs them who says nothing of solvers, and what every run has to keep.

No step may miss more of the forces on a body than the default allows, and nothing may be warned of.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.case.control import Solver
from castx.case.reading.read import read_case
from castx.command.watches.deformations import DeformationWatch
from castx.command.watches.ranges import RangeWatch
from castx.process.simulation import Simulation
from castx.process.state import State
from tests.elastic_bodies import everywhere

FORCE_TOLERANCE = Solver().mechanics_tolerance
PHYSICAL = {
    "time": {"end"},
    "coupling": {"scheme"},
    "bodies": {"name", "material", "temperature", "temperature_history", "law"},
    "contact": {"initial_gap", "friction"},
}
"""Keys that say what happens; all others of these tables say how it is solved."""


def by_default(comm: MPI.Intracomm, data: Mapping[str, Any]) -> Iterator[State]:
    """Yield the states of a run behind the initial one; collective.

    Args:
        comm: ranks of the run.
        data: a case that leaves everything to the defaults.
    """
    says_nothing_of_solvers(data)
    yield from accepted_steps(comm, data)


def says_nothing_of_solvers(data: Mapping[str, Any]) -> None:
    """Ask for a case that has physical keys only."""
    assert "solver" not in data and "output" not in data
    assert data["time"].keys() <= PHYSICAL["time"]
    assert data.get("coupling", {}).keys() <= PHYSICAL["coupling"]
    for body in data["bodies"]:
        assert body.keys() <= PHYSICAL["bodies"], body["name"]
    for interface in data.get("interfaces", []):
        assert interface.get("contact", {}).keys() <= PHYSICAL["contact"]


def accepted_steps(comm: MPI.Intracomm, data: Mapping[str, Any]) -> Iterator[State]:
    """Yield the states of a run behind the initial one, its forces in balance; collective."""
    case = read_case(data, Path("case.toml"))
    with _no_warning():
        run = Simulation.from_case(case, comm)
        ranges, deformation = RangeWatch(case, comm), DeformationWatch(case, comm)
        for state in run:
            ranges.check(state)
            deformation.check(state)
            if state.step > 0:
                in_balance(state)
                yield state
        assert run.is_finished
        run.destroy()


def in_balance(state: State) -> None:
    """Ask for forces on each body that are missing by no more than the default allows."""
    errors = {name: e for name, e in state.totals.items() if name.endswith(".force_error")}
    assert errors
    assert max(errors.values()) <= FORCE_TOLERANCE, (state.time, errors)


def bears(state: State, interface: str, weight: float) -> None:
    """Ask for a contact that bears a weight within 1 % [N]; pushes up if it is positive."""
    found = state.totals[f"{interface}.force.y"]
    assert abs(found - weight) <= 0.01 * abs(weight), (state.time, found)


def complies(state: State, weight: float) -> None:
    """Ask for no pull, no penetration and no frozen pair after a step; liquid may pull.

    Args:
        state: after the step.
        weight: scale of the forces [N].
    """
    comm, mechanics = state.mesh.comm, state.problem.mechanics
    assert mechanics is not None
    gaps, forces = mechanics.pair_values()
    solid = ~mechanics.equilibrium.present.active.held
    gaps, forces = everywhere(comm, gaps[solid]), everywhere(comm, forces[solid])
    assert forces.min(initial=0.0) > -1e-3 * weight
    assert gaps.min(initial=0.0) > -1e-12
    assert np.abs(forces * gaps).max(initial=0.0) < 1e-12 * weight
    assert state.counters.frozen_pairs == 0


class _Collected(logging.Handler):
    """Warnings, but that of thin walls: meshes are coarse here on purpose, and a run says so."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.messages: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        message = record.getMessage()
        if "with few cells across" not in message:
            self.messages.append(message)


@contextmanager
def _no_warning() -> Iterator[None]:
    """Ask for messages without a warning."""
    logger, collected = logging.getLogger("castx"), _Collected()
    logger.addHandler(collected)
    try:
        yield
    finally:
        logger.removeHandler(collected)
    assert not collected.messages
