"""Declaration of an output field: name, title, unit, place, colours, and how it is read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from castx.arrays import FloatArray
from castx.input.units import Dimension


class FieldPlace(Enum):
    """Where a field has its values."""

    NODE = "nodes"
    CELL = "cells"
    PAIR = "pairs"


class StateView(Protocol):
    """The state of one body, or of one interface, from which fields are read.

    Arrays have the local nodes, cells or owned pairs first, ghosts of nodes and cells included.
    """

    @property
    def step_size(self) -> float:
        """Size of the last accepted step [s]; 1 s before the first one."""

    def heat(self, name: str, /) -> FloatArray:
        """Return temperature [°C], enthalpy [J/m³] or solid_fraction, shape (nodes,)."""

    def displacement(self) -> FloatArray:
        """Return the displacement [m], shape (nodes, gdim)."""

    def pressure(self) -> FloatArray:
        """Return the mean stress [Pa], shape (nodes,); collective."""

    def stress(self) -> FloatArray:
        """Return the stress [Pa], shape (cells, 6): xx, yy, zz, xy, xz, yz."""

    def point_stress(self) -> FloatArray:
        """Return the stress at the integration points [Pa], shape (cells, 6 points)."""

    def stress_error(self) -> FloatArray:
        """Return the estimated error of the stress by the mesh [Pa], shape (cells,); collective."""

    def plastic_strain(self) -> FloatArray:
        """Return the equivalent plastic strain, shape (cells,)."""

    def plastic_strain_increment(self) -> FloatArray:
        """Return the plastic strain gained in the last accepted step, shape (cells,)."""

    def pores(self) -> FloatArray:
        """Return the share of the cells that is void, shape (cells,)."""

    def gap(self) -> FloatArray:
        """Return the gaps [m], shape (pairs,)."""

    def contact_pressure(self) -> FloatArray:
        """Return the contact pressures [Pa], shape (pairs,)."""

    def wall_suction(self) -> FloatArray:
        """Return by how much closed pairs are pulled [Pa], shape (pairs,)."""

    def resistance(self) -> FloatArray:
        """Return the thermal resistances [m²K/W], shape (pairs,)."""


@dataclass(frozen=True)
class FieldColours:
    """How the report shows a field as colours.

    Attributes:
        unit: in which it is shown.
        colours: name of the colour map.
        factor: from SI to the unit.
        caption: what is seen; {front} is where gradients are taken.
        melting: whether only the bodies that freeze show it; else the others have colours of
            their own, `beside`.
        beside: name of the colour map of bodies that do not freeze.
        final: whether it is shown at the end only.
        front: whether the line f_s = 0.5 is drawn.
        share: of the values inside the colours.
        rank: place in the order of the report.
    """

    unit: str
    colours: str
    factor: float = 1.0
    caption: str = ""
    melting: bool = False
    beside: str = "cividis"
    final: bool = False
    front: bool = False
    share: float = 1.0
    rank: int = 1000


@dataclass(frozen=True)
class OutputField:
    """A field that a case can ask for; the registry refuses one without title, unit, place or read.

    Attributes:
        name: as a case file writes it.
        title: heading in a foundry's words.
        unit: in the files, in SI with °C.
        place: where its values are.
        read: from a state; None: it is followed from step to step.
        followed: whether it is followed from step to step.
        dimension: of the column of a probe; None: probes do not record it.
        mechanical: whether a run without mechanics does not have it.
        components: 6 for a symmetric tensor in cells.
        shown: as colours; None: in the order of names after the others.
    """

    name: str
    title: str = ""
    unit: str = ""
    place: FieldPlace | None = None
    read: Callable[[StateView], FloatArray] | None = None
    followed: bool = False
    dimension: Dimension | None = None
    mechanical: bool = False
    components: int = 1
    shown: FieldColours | None = None

    def values(self, state: StateView) -> FloatArray:
        """Return the field of a state."""
        assert self.read is not None
        return self.read(state)

    def omissions(self) -> list[str]:
        """Return the missing parts of the declaration, in words."""
        missing = [key for key in ("title", "unit") if not getattr(self, key).strip()]
        if self.place is None:
            missing.append("place")
        if self.read is None and not self.followed:
            missing.append("read, or else followed=True")
        if self.read is not None and self.followed:
            missing.append("a choice between read and followed=True")
        return missing
