"""All files of one run behind one context manager."""

from __future__ import annotations

import json
import logging
from contextlib import suppress
from functools import partial
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from castx.case.fields.feeding import EMPTIED
from castx.errors import CaseError
from castx.foundry.followed.foundry_fields import (
    FoundryFields,
    pores_of,
    poured_bodies,
    solidification_of,
    written_names,
)
from castx.foundry.followed.histories import histories_of
from castx.foundry.pools.feeders import piped_metals
from castx.foundry.pools.hot_spots import HotSpots
from castx.foundry.pools.pooled_metal import pooled_metals
from castx.foundry.stress.cracks import cracks_of
from castx.foundry.stress.fed_surface import fed_surfaces
from castx.foundry.stress.stage_ends import StageEnds
from castx.foundry.stress.surface_forms import SurfaceForms
from castx.materials.lookup import find_material
from castx.profiling import PartCost, RunPart, booked_as
from castx.ranks import on_first_rank
from castx.results.description import describe
from castx.results.fields import Fields
from castx.results.files.disk import Disk
from castx.results.files.folder import (
    CASE,
    FIELDS,
    HISTORY,
    HOT_SPOTS,
    PROBES,
    RECORD,
    SERIES,
    claim_folder,
    make_room,
    write_whole,
)
from castx.results.files.measurements import measured_curves, write_measured
from castx.results.files.reason import Reason
from castx.results.files.series import damage_of
from castx.results.history import History
from castx.results.probes import Probes
from castx.results.record import RunRecord
from castx.results.states.quantities import MECHANICAL
from castx.results.states.snapshot import Snapshot
from castx.stateful import Arrays, Saved, joined, part_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from castx.case.case import Case
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs

NOT_BY_DEFAULT = {"thermal": {"gap"}, "mechanical": {"solid_fraction", "solidification_time"}}
"""Fields of the default that never change in a run of a scheme."""

log = logging.getLogger(__name__)


class ResultsWriter:
    """The results folder of one run: its tables, fields/, case.json and run.json.

    Making it checks everything that could be wrong with probes, fields and folder and touches no
    old results; entering it replaces them, or after `resume` goes on behind them. Leaving it writes
    the last accepted state and how the run ended; all files are whole then on all ranks. An
    exception other than ConvergenceError and KeyboardInterrupt may have struck one rank alone, so
    that nothing collective happens after it.

    >>> from mpi4py import MPI
    >>> import castx
    >>> case = castx.load_case("cylinder.toml", ["time.end=0.1", "geometry.size=1e-2"])
    >>> simulation = castx.Simulation.from_case(case, MPI.COMM_SELF)
    >>> with castx.ResultsWriter(case, simulation.mesh, simulation.pairs) as results:
    ...     for state in simulation:
    ...         results.write(state)
    >>> castx.Results(case.output.folder).history["time"].tolist()
    [0.0, 0.05, 0.1]

    Args:
        case: what is run.
        mesh: the bodies.
        pairs: the node pairs by the names of their interfaces.

    Raises:
        CaseError: the folder cannot be written, a probe lies outside its body, a measured curve
            cannot be read, or an unknown quantity is wanted; on all ranks.
    """

    def __init__(self, case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs]) -> None:
        self._comm, self._disk = mesh.comm, Disk(mesh.comm)
        self._folder = case.output.folder
        claim_folder(case, mesh.comm)
        refuse_without_mechanics(case)
        self._solidification = solidification_of(case, mesh)
        self._metals = pooled_metals(case)
        self._pools = HotSpots(mesh, self._metals)
        forms = SurfaceForms(mesh, case.foundry.flat, case.foundry.round)
        given = any(body.temperature_history is not None for body in case.bodies)
        heated = given or case.coupling.scheme != "mechanical"
        self._ends = StageEnds(mesh, deforming(case), forms, heated, fed_surfaces(case))
        self._cracks = cracks_of(case, mesh)
        poured = poured_bodies(case)
        self._histories = histories_of(
            case, mesh, pairs, partial(pores_of, self._solidification, poured)
        )
        followed = self._pools, self._ends, self._cracks, self._histories
        names = [body.name for body in case.bodies]
        between = [interface.name for interface in case.interfaces]
        self._history = History(self._folder / HISTORY, names, between)
        self._probes = Probes(self._folder / PROBES, case.probes, mesh, pairs)
        self._measured = measured_curves(case.measurements, self._probes.columns, mesh.comm)
        self._fields = Fields(
            self._folder / FIELDS,
            wanted_fields(case),
            case.output.every,
            mesh,
            FoundryFields(self._solidification, poured, *followed),
            self._disk,
            [body.name for body in case.bodies if melts(case, body.material)],
            case.output.format,
        )
        self._case = json.dumps(case.content, indent=2, ensure_ascii=False) + "\n"
        self._record = RunRecord(self._folder / RECORD, describe(case, mesh, pairs))
        self._rows = 0
        self._lost: dict[str, int] = {}
        self._resumed: Mapping[str, Any] | None = None

    def saved(self) -> dict[str, Saved]:
        """Return the state of the quantities that are followed from step to step; collective."""
        return joined(
            {
                "solidification": self._solidification.saved(),
                "pools": self._pools.saved(),
                "cracks": self._cracks.saved(),
                "histories": self._histories.saved(),
            }
        )

    def notes(self) -> dict[str, Any]:
        """Return written rows, outputs and histories for JSON; collective."""
        return {
            "rows": self._rows,
            "lost_rows": self._lost,
            "outputs": self._fields.notes(),
            "field_events": self._fields.events(),
            "record": self._record.notes(),
            "pools": self._pools.notes(),
            "stage_ends": self._ends.described(),
        }

    def resume(self, arrays: Arrays, notes: Mapping[str, Any], snapshot: Snapshot) -> None:
        """Go on behind the rows and outputs that `notes` names, from a state; collective.

        Raises:
            CaseError: a table lacks rows, or is damaged; on all ranks.
        """
        self._lost = on_first_rank(self._comm, lambda: lost_rows(self._folder, notes))
        self._solidification.restore(part_of(arrays, "solidification"))
        self._pools.restore(part_of(arrays, "pools"), notes.get("pools", {}))
        self._cracks.restore(part_of(arrays, "cracks"))
        self._histories.restore(part_of(arrays, "histories"))
        self._ends.resume(notes.get("stage_ends", []))
        self._record.resume(notes["record"])
        self._record.note_hot_spots(self._pools.described())
        self._fields.go_on(notes["field_events"], snapshot)
        self._rows, self._resumed = notes["rows"], notes

    def __enter__(self) -> Self:
        if self._resumed is not None:  # refuses damaged files before it writes anything
            with self._disk.writing():
                (self._folder / FIELDS).mkdir(exist_ok=True)
                self._fields.resume(self._resumed["outputs"])
            self._disk.raise_failures()
        if self._comm.rank == 0:
            with self._disk.writing():
                if self._resumed is None:
                    make_room(self._folder)
                self._record.write(Reason.RUNNING)
                write_whole(self._folder / CASE, self._case)
                write_measured(self._folder, self._measured)
                (self._folder / FIELDS).mkdir(exist_ok=True)
                kept = [self._rows - self._lost.get(name, 0) for name in SERIES]
                self._probes.open(None if self._resumed is None else kept[0])
                if self._resumed is not None:
                    self._history.resume(kept[1])
        self._disk.raise_failures()
        return self

    @booked_as(RunPart.OUTPUT)
    def write(self, snapshot: Snapshot) -> None:
        """Write the initial state or that after an accepted step; collective.

        Raises:
            StorageError: the disk did not take it; on all ranks.
        """
        self._record.update(snapshot)
        self._fields.leave_stage(snapshot)
        self._solidification.update(snapshot)
        self._pools.update(snapshot)
        self._ends.update(snapshot)
        self._cracks.update(snapshot)
        self._histories.update(snapshot)
        self._record.note_followed(self._histories.described())
        totals = self._histories.totals()
        self._record.note_hot_spots(self._pools.described())
        with self._disk.writing():
            self._probes.append(snapshot)
        if self._comm.rank == 0:
            with self._disk.writing():
                self._history.append(snapshot, totals)
        self._rows += 1
        self._fields.update(snapshot)
        self._disk.raise_failures()

    def write_pending(self) -> None:
        """Write the fields of the last state unless that is done; collective."""
        self._fields.write_pending()

    def sync(self) -> None:
        """Bring the tables to disk, so that a checkpoint never has more rows than they; collective.

        Raises:
            StorageError: the disk did not take them; on all ranks.
        """
        if self._comm.rank == 0:
            with self._disk.writing():
                self._probes.sync()
                self._history.sync()
        self._disk.raise_failures()

    def note_profile(self, costs: Mapping[RunPart, PartCost]) -> None:
        """Write the cost of the parts of the run into run.json."""
        self._record.note_profile(costs)

    def note_interruption(self) -> None:
        """Write down at once that the run was interrupted: it may be killed before it can stop."""
        if self._comm.rank == 0:
            with suppress(OSError):  # of a full disk: called by a signal, it may not raise
                self._record.write(Reason.INTERRUPTED, "killed before the end of its step")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        reason = Reason.of(error)
        message = "" if error is None else str(error)
        for table in (self._probes, self._history):
            with suppress(OSError):  # of a full disk, which was found out before
                table.close()
        if reason is Reason.FAILED:
            with suppress(OSError):
                self._record.write(reason, message)
            return
        self._fields.write_pending()
        self._record.note_stage_ends(self._ends.described())
        if self._comm.rank == 0:
            with self._disk.writing():
                self._record.write(reason, message)
                if self._metals:
                    write_whole(self._folder / HOT_SPOTS, self._pools.table())
        self._disk.raise_failures()


def lost_rows(folder: Path, notes: Mapping[str, Any]) -> dict[str, int]:
    """Return the number of first rows that each table lacks since its removal by the user.

    Args:
        folder: the results folder.
        notes: those of the checkpoint from which a run goes on.

    Raises:
        CaseError: a table is there and does not have the rows up to the checkpoint.
    """
    rows, time = notes["rows"], notes["record"]["time_reached"]
    lost = dict(notes.get("lost_rows", {}))
    for path in (folder / name for name in SERIES):
        if not path.exists():
            log.warning("%s is missing: what it held up to t = %g s is lost", path, time)
            lost[path.name] = rows
            continue
        damage = damage_of(path, rows - lost.get(path.name, 0), time)
        if damage is not None:
            raise CaseError(
                f"{path} is not as the run has left it: {damage}; put a whole copy in its place, "
                "or remove it to go on without the lines that it had"
            )
    return lost


def wanted_fields(case: Case) -> list[str]:
    """Return the names of the fields to write."""
    return [name for entry in wanted_entries(case) for name in written_names(entry, case)]


def wanted_entries(case: Case) -> list[str]:
    """Return the entries of output.fields, or those of the default that the run has.

    The pipe is a part of the shape, and so of the default where castings have one.
    """
    asked = "fields" in case.output.model_fields_set
    lacking = set() if asked else NOT_BY_DEFAULT.get(case.coupling.scheme, set())
    piped = (EMPTIED,) if not asked and piped_metals(case) else ()
    return [
        entry
        for entry in (*case.output.fields, *piped)
        if (case.coupling.scheme != "thermal" or entry not in MECHANICAL) and entry not in lacking
    ]


def deforming(case: Case) -> list[str]:
    """Return the names of the bodies that deform in a case."""
    if case.coupling.scheme == "thermal":
        return []
    return [body.name for body in case.bodies if body.law != "rigid"]


def refuse_without_mechanics(case: Case) -> None:
    """Refuse mechanical quantities that a run without mechanics does not have.

    Raises:
        CaseError: with the place in the case and the name.
    """
    if case.coupling.scheme != "thermal":
        return
    asked = [(f"probe {probe.name!r}", probe.quantities) for probe in case.probes]
    if "fields" in case.output.model_fields_set:
        asked.append(("output.fields", case.output.fields))
    for where, names in asked:
        for name in names:
            if name in MECHANICAL:
                raise CaseError(
                    f'{where}: there is no {name} in a run with coupling.scheme = "thermal"; leave '
                    "it out or choose another scheme"
                )


def melts(case: Case, name: str) -> bool:
    """Return whether a material melts."""
    return find_material(name, case.materials).melts
