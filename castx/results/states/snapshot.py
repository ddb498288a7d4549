"""Protocol of the state after an accepted step, from which all results are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from castx.arrays import FloatArray
from castx.solvers.counters import StepCounters

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs

FULLY_SOLID = 1.0 - 1e-6
"""Solid fraction from which a body counts as solid."""


@dataclass(frozen=True, kw_only=True)
class ProcessState:
    """Stage, cycle and events of a process.

    Args:
        stage: number of the stage; 0 is the start.
        cycle: number of the cycle, from 1.
        cycle_start: time at which it has begun [s].
        cycles_ended: number of the cycles that have come to their end.
        renewed: bodies that were new when the last step began.
        events: stages that have begun and cycles that have ended so far, as JSON knows them.
        staged: whether there are several stages at all.
    """

    stage: int = 0
    cycle: int = 1
    cycle_start: float = 0.0
    cycles_ended: int = 0
    renewed: frozenset[str] = frozenset()
    events: tuple[Mapping[str, Any], ...] = ()
    staged: bool = False


class Snapshot(Protocol):
    """The state after an accepted step; the first one is the initial state, with step number 0.

    Arrays are valid until the next step is tried; copy those that must last longer.
    `totals` are reduced over the ranks already: the columns of history.csv after the counters.
    """

    @property
    def time(self) -> float:
        """End of the step [s]."""

    @property
    def step(self) -> int:
        """Number of the step; 0 is the initial state."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there and their meshes."""

    @property
    def pairs(self) -> Mapping[str, NodePairs]:
        """The node pairs of these bodies by the name of their interface."""

    @property
    def counters(self) -> StepCounters:
        """Effort of the step."""

    @property
    def process(self) -> ProcessState:
        """Stage, cycle and events."""

    @property
    def totals(self) -> Mapping[str, float]:
        """Totals of bodies and interfaces by the name of their column, equal on all ranks."""

    def nodal(self, body: str, name: str) -> FloatArray:
        """Return a nodal field with ghosts: (nodes,), the displacement (nodes, gdim).

        Names: temperature [°C], enthalpy [J/m³], solid_fraction, displacement [m], pressure [Pa].
        """

    def is_hindered(self, body: str) -> bool:
        """Return whether supports keep a body from shrinking evenly."""

    def cellwise(self, body: str, name: str) -> FloatArray:
        """Return a field constant in each cell, with ghosts: (cells,), the stress (cells, 6).

        Names: stress [Pa] as xx yy zz xy xz yz (axisymmetric: rr zz θθ rz 0 0), von_mises [Pa],
        plastic_strain, largest_principal_stress and smallest_principal_stress [Pa],
        point_stress [Pa] at the integration points, one after the other, (cells, 6 points),
        mechanical_strain (cells, 6), elastic and inelastic, viscoplastic_strain (cells, 6), both as
        the stress, and coherent, 1 in cells that are solid.
        """

    def paired(self, interface: str, name: str) -> FloatArray:
        """Return a field of the owned pairs: (pairs,).

        Names: gap [m], contact_pressure [Pa], heat_transfer_coefficient [W/m²/K].
        """
