"""fields/: VTU pieces of all bodies, ranks and times, and the collection that lists them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol
from xml.sax.saxutils import quoteattr

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.followed import histories
from castx.foundry.followed.foundry_fields import entry_of, is_of_foundry
from castx.foundry.stress.cracks import COLD_CRACKS
from castx.foundry.stress.stage_ends import DEVIATION
from castx.results.field_copies import FieldCopies, between
from castx.results.field_times import FieldTimes
from castx.results.files.disk import Disk
from castx.results.files.folder import COLLECTION, write_whole
from castx.results.files.vtu import Piece, write_piece
from castx.results.states.quantities import CELLWISE, PAIRED, UNITS, on_secondary_nodes
from castx.results.states.snapshot import Snapshot

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

LATE_IN_CELLS = (COLD_CRACKS, *histories.CELLWISE)
"""Fields in cells that are found when they are written."""


@dataclass(frozen=True)
class WrittenMoment:
    """A moment on disk.

    Attributes:
        time: [s].
        holders: the ranks that had cells of each body.
    """

    time: float
    holders: Mapping[str, Sequence[int]]


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
    ) -> None:
        self._folder = folder
        self._names = tuple(names)
        self._melting = tuple(mesh.bodies) if melting is None else tuple(melting)
        self._times = FieldTimes(every, self._melting)
        self._comm, self._disk = mesh.comm, disk
        self._foundry = foundry
        self._pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}
        filled = self._comm.allgather([piece.cells > 0 for piece in self._pieces.values()])
        self._holders = {
            name: [rank for rank, of_rank in enumerate(filled) if of_rank[index]]
            for index, name in enumerate(self._pieces)
        }
        self._outputs: list[WrittenMoment] = []
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
        if last is not None and (not self._outputs or self._outputs[-1].time < last.time):
            self._write(last)

    def _write(self, state: FieldCopies) -> None:
        index = len(self._outputs)
        self._add_foundry(state)
        with self._disk.writing():
            for number, (body, piece) in enumerate(self._pieces.items()):
                if piece.cells > 0 and body in state.nodal:
                    path = self._folder / piece_name(body, index, self._comm.rank)
                    fields = state.nodal[body], state.cellwise[body]
                    write_piece(path, piece, number, *fields, body, units_of(self._names))
        self._disk.raise_failures()
        holders = {body: ranks for body, ranks in self._holders.items() if body in state.nodal}
        self._outputs.append(WrittenMoment(state.time, holders))
        if self._comm.rank == 0:
            with self._disk.writing():
                self._write_collection()

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

    def _write_collection(self) -> None:
        write_whole(self._folder / COLLECTION, collection(self._outputs))

    def notes(self) -> list[dict[str, Any]]:
        """Return a description of the written files, for JSON."""
        return [asdict(output) for output in self._outputs]

    def events(self) -> dict[str, object]:
        """Return the events that have been written, for JSON."""
        return self._times.notes()

    def go_on(self, events: Mapping[str, object], snapshot: Snapshot) -> None:
        """Follow the run from the state of a checkpoint with these events; collective."""
        self._last = self._copy(snapshot)
        self._times.resume(events, snapshot)

    def resume(self, notes: Sequence[Mapping[str, Any]]) -> None:
        """Go on behind the outputs of `notes`; pieces of later ones are removed."""
        self._outputs = [WrittenMoment(**note) for note in notes]
        if self._comm.rank > 0:
            return
        known = {name for index, _, name in pieces_of(self._outputs)}
        for path in self._folder.glob("*.vtu"):
            if path.name not in known:
                path.unlink()
        self._write_collection()


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


def piece_name(body: str, index: int, rank: int) -> str:
    """Return the name of the file of one body, output and rank."""
    return f"{body}_{index:05d}_{rank}.vtu"


def pieces_of(outputs: Sequence[WrittenMoment]) -> Iterator[tuple[int, str, str]]:
    """Yield the number of the output, the body and the name of the file of all pieces."""
    for index, output in enumerate(outputs):
        for body, ranks in output.holders.items():
            for rank in ranks:
                yield index, body, piece_name(body, index, rank)


def collection(outputs: Sequence[WrittenMoment]) -> str:
    """Return the text of the collection of all pieces."""
    lines = ['<VTKFile type="Collection" version="1.0">', "  <Collection>"]
    part, last = 0, -1
    for index, body, name in pieces_of(outputs):
        part, last = part + 1 if index == last else 0, index
        lines.append(
            f'    <DataSet timestep="{outputs[index].time!r}" group={quoteattr(body)} '
            f'part="{part}" file={quoteattr(name)}/>'
        )
    return "\n".join([*lines, "  </Collection>", "</VTKFile>", ""])
