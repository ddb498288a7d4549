"""fields/: VTU pieces of all bodies, ranks and times, and the collection that lists them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from castx.quantities import QUANTITIES, Solidification
from castx.results.folder import write_whole
from castx.results.names import CELLWISE, PAIRED
from castx.results.pairs import on_secondary_nodes
from castx.results.vtu import Piece, write_piece
from castx.snapshot import Snapshot
from castx.tables import FloatArray

if TYPE_CHECKING:
    from castx.mesh import CastingMesh

COLLECTION = "castx.pvd"


@dataclass
class State:
    """Copies of the wanted fields of one moment: arrays of the pieces of this rank by body."""

    time: float
    nodal: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    cellwise: dict[str, dict[str, FloatArray]] = field(default_factory=dict)


class Fields:
    """Writer of the fields at chosen times; the last state is kept, to be written at any end.

    Args:
        folder: the folder of the files.
        names: the wanted fields.
        every: time between outputs [s]; None: first and last state only.
        mesh: the bodies.
        solidification: the foundry quantities, followed elsewhere.
    """

    def __init__(
        self,
        folder: Path,
        names: Sequence[str],
        every: float | None,
        mesh: CastingMesh,
        solidification: Solidification,
    ) -> None:
        self._folder = folder
        self._names = tuple(names)
        self._every = every
        self._comm = mesh.comm
        self._solidification = solidification
        self._pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}
        filled = self._comm.allgather([piece.cells > 0 for piece in self._pieces.values()])
        self._holders = {
            name: [rank for rank, of_rank in enumerate(filled) if of_rank[index]]
            for index, name in enumerate(self._pieces)
        }
        self._times: list[float] = []
        self._pending: State | None = None

    def update(self, snapshot: Snapshot) -> None:
        """Take over the state after an accepted step, and write it when its time has come."""
        self._pending = self._copy(snapshot)
        if snapshot.step == 0 or self._due(snapshot.time):
            self.write_pending()

    def _due(self, now: float) -> bool:
        """Return whether a multiple of `every` lies after the last output and not after now."""
        if self._every is None or not self._times:
            return False
        slack = 1e-9 * self._every
        return (now + slack) // self._every > (self._times[-1] + slack) // self._every

    def _copy(self, snapshot: Snapshot) -> State:
        """Return copies of the wanted fields; collective."""
        state = State(snapshot.time)
        for body, piece in self._pieces.items():
            state.nodal[body] = {
                name: self._nodal(snapshot, body, name)[piece.nodes]
                for name in self._names
                if name not in CELLWISE
            }
            state.cellwise[body] = {
                name: snapshot.cellwise(body, name)[: piece.cells].copy()
                for name in self._names
                if name in CELLWISE
            }
        return state

    def _nodal(self, snapshot: Snapshot, body: str, name: str) -> FloatArray:
        if name in QUANTITIES:
            return self._solidification.nodal(body, name)
        if name in PAIRED:
            return interface_field(snapshot, body, name)
        return snapshot.nodal(body, name)

    def write_pending(self) -> None:
        """Write the last state unless that is done; collective through one barrier."""
        if self._pending is None:
            return
        state, index = self._pending, len(self._times)
        for number, (body, piece) in enumerate(self._pieces.items()):
            if piece.cells > 0:
                path = self._folder / piece_name(body, index, self._comm.rank)
                write_piece(path, piece, number, state.nodal[body], state.cellwise[body])
        self._times.append(state.time)
        self._pending = None
        self._comm.Barrier()
        if self._comm.rank == 0:
            write_whole(self._folder / COLLECTION, collection(self._times, self._holders))


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
        here = snapshot.mesh.bodies[body].surface_nodes(pairs.primary)
        combined = np.where(seen[here], extreme(field_values[here], values[here]), values[here])
        field_values[here], seen[here] = combined, True
    return field_values


def piece_name(body: str, index: int, rank: int) -> str:
    """Return the name of the file of one body, output and rank."""
    return f"{body}_{index:05d}_{rank}.vtu"


def collection(times: Sequence[float], holders: Mapping[str, Sequence[int]]) -> str:
    """Return the text of the collection of all pieces.

    Args:
        times: of the outputs [s].
        holders: the ranks that have cells of each body.
    """
    lines = ['<VTKFile type="Collection" version="1.0">', "  <Collection>"]
    for index, time in enumerate(times):
        pieces = [(body, rank) for body, ranks in holders.items() for rank in ranks]
        for part, (body, rank) in enumerate(pieces):
            lines.append(
                f'    <DataSet timestep="{time!r}" group={quoteattr(body)} part="{part}" '
                f"file={quoteattr(piece_name(body, index, rank))}/>"
            )
    return "\n".join([*lines, "  </Collection>", "</VTKFile>", ""])
