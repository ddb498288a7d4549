"""Margin against hot tearing by the pressure that a run finds in the mush.

A film of melt tears where the suction reaches Δp_c while dendrites have not grown together yet, at
liquid fractions g above g_c. `castx.foundry.suction` estimates that suction in a column from
gradient, speed and rate of strain of its place; with flow through the mush the run has the pressure
itself, by shrinkage, strain and feeding over all distances at once. The margin is

    max p/Δp_c  while g > g_c,

p the mean over a step, which counts where g in the middle of the step does. What melts begins anew.
After the idea of M. Rappaz, J.-M. Drezet and M. Gremaud (1999), whose Δp_c it takes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.case.bodies import DARCY
from castx.case.case import Case
from castx.foundry.alloy import Alloy
from castx.foundry.suction import TEARING_DEPRESSION
from castx.materials.lookup import find_material
from castx.stateful import Arrays, Saved, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

SUCTION_MARGIN = "suction_margin"
"""Name of the field."""


class MushyState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def process(self) -> Any:
        """Stage and cycle, and bodies that are new."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return a nodal field with ghosts."""


@dataclass(frozen=True)
class TearingMelt:
    """When films of a melt tear.

    Attributes:
        depression: Δp_c [Pa].
        cut_off: g_c, a liquid fraction.
    """

    depression: float
    cut_off: float


class LargestSuction:
    """The largest suction of the melt so far at the nodes of one body.

    Args:
        body: its mesh.
        melt: of the body.
    """

    def __init__(self, body: BodyMesh, melt: TearingMelt) -> None:
        self._body, self._melt = body, melt
        self.begin()

    def begin(self) -> None:
        """Forget the suctions so far; no solid fraction is known."""
        nodes = len(self._body.parent_vertices)
        self._largest: FloatArray = np.zeros(nodes)
        self._solid: FloatArray = np.full(nodes, np.nan)

    def update(self, solid: FloatArray, stress: FloatArray) -> None:
        """Take over the state after an accepted step.

        Args:
            solid: solid fraction of the local nodes, (nodes,).
            stress: p [Pa], (nodes,).
        """
        connected = 1.0 - 0.5 * (self._solid + solid) > self._melt.cut_off
        self._largest = np.where(connected, np.maximum(self._largest, stress), self._largest)
        self._largest[solid <= 0.0] = 0.0
        self._solid = solid.copy()

    @property
    def margin(self) -> FloatArray:
        """Largest suction over Δp_c, shape (nodes,)."""
        return np.asarray(self._largest / self._melt.depression, dtype=np.float64)

    def saved(self) -> dict[str, Saved]:
        """Return largest suctions and the last solid fractions."""
        nodes = self._body.node_numbering
        return {"largest": Saved(self._largest, nodes), "solid": Saved(self._solid, nodes)}

    def restore(self, arrays: Arrays) -> None:
        """Take them back."""
        self._largest, self._solid = arrays["largest"].copy(), arrays["solid"].copy()


class SuctionMargins:
    """Margins of all bodies through whose mush melt flows.

    Args:
        mesh: of all bodies.
        melts: of the bodies to follow, by name.
    """

    def __init__(self, mesh: CastingMesh, melts: Mapping[str, TearingMelt]) -> None:
        self._found = {n: LargestSuction(mesh.bodies[n], melt) for n, melt in melts.items()}

    def update(self, state: MushyState) -> None:
        """Take over the state after an accepted step; collective."""
        for body, found in self._found.items():
            if body in state.process.renewed:
                found.begin()
            if body in state.mesh.bodies:
                found.update(state.nodal(body, "solid_fraction"), state.nodal(body, "pressure"))

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return the margin at the local nodes, (nodes,); None: nothing is known."""
        if name != SUCTION_MARGIN or body not in self._found:
            return None
        return self._found[body].margin

    def totals(self) -> dict[str, float]:
        """Return nothing: there is no column of it."""
        return {}

    def described(self) -> dict[str, Any]:
        """Return nothing: the field has it."""
        return {}

    def saved(self) -> dict[str, Saved]:
        """Return the suctions of all bodies; collective."""
        return saved_parts(self._found)

    def restore(self, arrays: Arrays) -> None:
        """Go on with the suctions of an earlier part; others begin now."""
        for name, found in self._found.items():
            if part := part_of(arrays, name):
                found.restore(part)


def suction_margins_of(case: Case, mesh: CastingMesh) -> SuctionMargins:
    """Return the margins that a case asks for, of bodies with `feeding = "darcy"`."""
    melts = {}
    if SUCTION_MARGIN in case.output.fields:
        for body in case.bodies:
            if body.feeding == DARCY:
                alloy = Alloy(find_material(body.material, case.materials))
                depression = alloy.melt(TEARING_DEPRESSION).cavitation
                melts[body.name] = TearingMelt(depression, alloy.cut_off)
    return SuctionMargins(mesh, melts)
