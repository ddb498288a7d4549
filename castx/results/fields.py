"""fields/: the fields of all bodies at events and given times."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.motion import DEVIATION
from castx.foundry.followed import histories
from castx.foundry.followed.foundry_fields import entry_of, is_of_foundry
from castx.foundry.stress.cracks import COLD_CRACKS
from castx.results.field_copies import FieldCopies, between
from castx.results.field_files import field_files
from castx.results.field_times import FieldTimes
from castx.results.files.disk import Disk
from castx.results.files.vtu import Piece
from castx.results.states.quantities import CELLWISE, PAIRED, UNITS, on_secondary_nodes
from castx.results.states.snapshot import Snapshot

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

LATE_IN_CELLS = (COLD_CRACKS, *histories.CELLWISE)
"""Fields in cells that are found when they are written."""


class FoundrySource(Protocol):
    """Where the quantities of the foundry, and the deviation from the nominal shape, come from."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return a quantity at the nodes of a body, ghosts included: (nodes,); collective."""

    def cellwise(self, body: str, name: str, /) -> FloatArray:
        """Return a quantity in the cells of a body, ghosts included: (cells,)."""


class Fields:
    """Writer of the fields at events and given times; the last state is kept, for any end.

    Fields of a time within a step are linear between its start and its end; those that are followed
    from step to step, such as the solidification time, are those of its end.

    Args:
        folder: the folder of the files.
        names: the wanted fields.
        every: time between given moments [s]; None: events, first and last state only.
        mesh: the bodies.
        foundry: the quantities of the foundry.
        disk: takes the failures of single ranks.
        melting: the bodies that melt, which alone have solid fraction and foundry quantities; None:
            all.
        form: of the files, one of `castx.case.output.FORMATS`.
    """

    def __init__(
        self,
        folder: Path,
        names: Sequence[str],
        every: float | None,
        mesh: CastingMesh,
        foundry: FoundrySource,
        disk: Disk,
        melting: Collection[str] | None = None,
        form: str = "vtkhdf",
    ) -> None:
        self._names = tuple(names)
        self._melting = tuple(mesh.bodies) if melting is None else tuple(melting)
        self._times = FieldTimes(every, self._melting)
        self._foundry = foundry
        self._pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}
        self._files = field_files(form, folder, mesh, self._pieces, units_of(self._names), disk)
        self._last: FieldCopies | None = None

    def update(self, snapshot: Snapshot) -> None:
        """Take over the state after an accepted step, and write the moments within the step.

        In the first cycle the last state of each stage is written as well; collective.
        """
        self.leave_stage(snapshot)
        before, self._last = self._last, self._copy(snapshot)
        if before is None:
            self._times.begin(snapshot)
            self.write_pending()
            return
        for time in self._times.within(snapshot):
            self._write(between(before, self._last, time))

    def leave_stage(self, snapshot: Snapshot) -> None:
        """Write the last state of a stage of the first cycle if a state is of another one.

        Call it before the quantities of the foundry are followed to that state; collective.
        """
        if self._last is not None and self._last.phase != phase_of(snapshot):
            if self._last.phase[0] == 1:
                self.write_pending()

    def _copy(self, snapshot: Snapshot) -> FieldCopies:
        """Return copies of the wanted fields; collective."""
        state = FieldCopies(snapshot.time, phase_of(snapshot))
        for body, piece in self._pieces.items():
            if body not in snapshot.mesh.bodies:
                continue
            state.nodal[body] = {
                name: self._nodal(snapshot, body, name)[piece.nodes]
                for name in self._names
                if name not in CELLWISE
                and not found_late(name)
                and (body in self._melting or not of_melting(name))
            }
            state.cellwise[body] = {
                name: snapshot.cellwise(body, name)[: piece.cells].copy()
                for name in self._names
                if name in CELLWISE
            }
        return state

    def _nodal(self, snapshot: Snapshot, body: str, name: str) -> FloatArray:
        if name in PAIRED:
            return interface_field(snapshot, body, name)
        return snapshot.nodal(body, name)

    def write_pending(self) -> None:
        """Write the last state unless that is done; collective.

        Raises:
            StorageError: the disk did not take it; on all ranks.
        """
        last = self._last
        if last is not None and (self._files.last is None or self._files.last < last.time):
            self._write(last)

    def _write(self, state: FieldCopies) -> None:
        self._add_foundry(state)
        self._files.write(state)

    def _add_foundry(self, state: FieldCopies) -> None:
        """Find the wanted quantities of the foundry for a moment to be written; collective.

        It is the last one to which they were followed.
        """
        for body, known in state.nodal.items():
            here, cells = self._pieces[body].nodes, self._pieces[body].cells
            for name in self._names:
                if name in LATE_IN_CELLS:
                    found = self._foundry.cellwise(body, name)
                    state.cellwise[body][name] = found[:cells].copy()
                elif found_late(name) and (body in self._melting or not of_melting(name)):
                    known[name] = self._foundry.nodal(body, name)[here]

    def notes(self) -> list[dict[str, Any]]:
        """Return a description of the written files, for JSON."""
        return self._files.notes()

    def events(self) -> dict[str, object]:
        """Return the events that have been written, for JSON."""
        return self._times.notes()

    def go_on(self, events: Mapping[str, object], snapshot: Snapshot) -> None:
        """Follow the run from the state of a checkpoint with these events; collective."""
        self._last = self._copy(snapshot)
        self._times.resume(events, snapshot)

    def resume(self, notes: Sequence[Mapping[str, Any]]) -> None:
        """Go on behind the moments of `notes`; later ones are removed."""
        self._files.resume(notes)


def found_late(name: str) -> bool:
    """Return whether a field is found when it is written, from what is followed or kept."""
    return name == DEVIATION or name in (*LATE_IN_CELLS, *histories.NODAL) or is_of_foundry(name)


def of_melting(name: str) -> bool:
    """Return whether only bodies that melt have a field."""
    return name == "solid_fraction" or is_of_foundry(name)


def units_of(names: Sequence[str]) -> dict[str, str]:
    """Return the units of fields, by their names in the files."""
    return {name: UNITS[entry_of(name)] for name in names}


def phase_of(snapshot: Snapshot) -> tuple[int, int]:
    """Return cycle and stage of a snapshot."""
    return snapshot.process.cycle, snapshot.process.stage


def interface_field(snapshot: Snapshot, body: str, name: str) -> FloatArray:
    """Return a quantity of pairs on the body that is secondary in them: (nodes,); collective.

    Zero off the interfaces. A node of several shows the smallest gap, and the largest of others.
    """
    space = snapshot.mesh.bodies[body].nodes
    nodes = space.dofmap.index_map.size_local + space.dofmap.index_map.num_ghosts
    field_values, seen = np.zeros(nodes), np.zeros(nodes, dtype=bool)
    extreme = np.minimum if name == "gap" else np.maximum
    for interface, pairs in snapshot.pairs.items():
        if pairs.secondary != body:
            continue
        values = on_secondary_nodes(snapshot, interface, name)
        here = snapshot.mesh.bodies[body].surface_nodes(pairs.surface)
        combined = np.where(seen[here], extreme(field_values[here], values[here]), values[here])
        field_values[here], seen[here] = combined, True
    return field_values
