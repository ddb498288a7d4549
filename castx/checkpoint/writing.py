"""Times at which a run writes its checkpoint, its content, and the restart from it."""

from __future__ import annotations

import logging
import time as clock
from collections.abc import Mapping
from datetime import UTC, datetime
from types import TracebackType
from typing import Any, Self

from castx.case.case import Case
from castx.case.reading.changes import refuse_changes
from castx.checkpoint.file import Checkpoint
from castx.checkpoint.header import CURE, checked, refuse_what_is_no_number
from castx.environment import versions
from castx.errors import CaseError, ConvergenceError, Interrupted
from castx.process.simulation import Simulation
from castx.profiling import RunPart, booked_as
from castx.results.files.folder import record_of
from castx.results.writing import ResultsWriter
from castx.stateful import Array, Saved, joined, part_of

log = logging.getLogger(__name__)

EVERY = 60.0
"""Wall clock time between checkpoints where the case does not say how often it wants them [s]."""
LARGEST_SHARE = 0.05
"""Share of the wall clock time that they may take then."""


class Checkpoints:
    """Writes the checkpoint of a run: of the initial state, at intervals, and at its end.

    The end is written when all ranks have come to it: done, not converged or interrupted.

    Args:
        checkpoint: the file.
        case: what is run.
        simulation: the run, whose state is saved.
        results: its results, whose state is saved as well.
    """

    def __init__(
        self, checkpoint: Checkpoint, case: Case, simulation: Simulation, results: ResultsWriter
    ) -> None:
        self._checkpoint, self._case = checkpoint, case
        self._simulation, self._results = simulation, results
        self._comm = simulation.mesh.comm
        self._every = case.output.checkpoint
        self._at: float | None = None
        self._written, self._cost = clock.monotonic(), 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None or isinstance(error, ConvergenceError | Interrupted):
            self._results.write_pending()
            self.write()

    @booked_as(RunPart.OUTPUT)
    def write_when_due(self) -> None:
        """Write a checkpoint after an accepted step if it is time; collective."""
        if self._at is None or self._is_due():
            self.write()

    def _is_due(self) -> bool:
        now, last = self._simulation.time, self._at
        assert last is not None
        if self._every is not None:
            slack = 1e-9 * self._every
            return (now + slack) // self._every > (last + slack) // self._every
        waited = clock.monotonic() - self._written
        return bool(self._comm.bcast(waited > max(EVERY, self._cost / LARGEST_SHARE)))

    def write(self) -> None:
        """Write a checkpoint of the last accepted state; collective.

        Raises:
            StorageError: the disk does not take it; the last one is still there.
        """
        begin = clock.monotonic()
        self._results.sync()
        self._checkpoint.write(self._state(), self._header())
        self._at, self._written = self._simulation.time, clock.monotonic()
        self._cost = self._written - begin

    def _state(self) -> dict[str, Saved]:
        return joined({"simulation": self._simulation.saved(), "results": self._results.saved()})

    def _header(self) -> dict[str, Any]:
        simulation = self._simulation
        return {
            "castx": versions()["castx"],
            "written": datetime.now(UTC).isoformat(timespec="seconds"),
            "time": simulation.time,
            "step": simulation.step,
            "ranks": self._comm.size,
            "mesh": simulation.mesh.digest,
            "case": self._case.content,
            "process": self._simulation.notes(),
            "results": self._results.notes(),
        }

    def restore(self, header: Mapping[str, Any]) -> None:
        """Restore simulation and results from the checkpoint with this header; collective.

        Raises:
            CaseError: the mesh or the arrays are not those of the case; on all ranks.
        """
        if header["mesh"] != self._simulation.mesh.digest:
            raise CaseError(
                f"the mesh is not the one of {self._checkpoint.path}: its file or the version of "
                "gmsh has changed; take the old one, or run the case anew without --restart"
            )
        path = str(self._checkpoint.path)
        try:
            self._take_up(header, path)
        except CaseError:
            raise
        except (AttributeError, IndexError, KeyError, TypeError, ValueError) as fault:
            kind = type(fault).__name__
            raise CaseError(
                f"the checkpoint {path} is damaged: its header does not fit its arrays or the case "
                f"({kind}: {fault}); {CURE}"
            ) from fault
        self._at = self._simulation.time
        if header["castx"] != versions()["castx"]:
            log.warning(
                "the checkpoint is of castx %s, this is %s: numbers may change where the run goes "
                "on", header["castx"], versions()["castx"],
            )  # fmt: skip
        log.info(
            "going on from t = %g s, step %d (checkpoint of %s)",
            header["time"], header["step"], header["written"],
        )  # fmt: skip

    def _take_up(self, header: Mapping[str, Any], path: str) -> None:
        self._simulation.prepare(header["process"])
        wanted = self._state()
        missing = {name for name in wanted if name.startswith("simulation/")}
        missing -= set(header["arrays"])
        if missing:
            raise CaseError(
                f"{self._checkpoint.path} was written by castx {header['castx']} and lacks "
                f"{min(missing)}; go on with that version, or run the case anew without --restart"
            )
        arrays = self._checkpoint.read(header, wanted)
        self._refuse_no_numbers(arrays, path)
        self._simulation.restore(part_of(arrays, "simulation"))
        self._refuse_another_moment(header, path)
        state = self._simulation.state()
        self._results.resume(part_of(arrays, "results"), header["results"], state)

    def _refuse_another_moment(self, header: Mapping[str, Any], path: str) -> None:
        simulation = self._simulation
        if (simulation.time, simulation.step) != (header["time"], header["step"]):
            raise CaseError(
                f"the checkpoint {path} is damaged: its state is of t = {simulation.time:g} s, "
                f"step {simulation.step}, its header of t = {header['time']:g} s, step "
                f"{header['step']}; {CURE}"
            )

    def _refuse_no_numbers(self, arrays: Mapping[str, Array], path: str) -> None:
        refusal = None
        try:
            refuse_what_is_no_number(arrays, path)
        except CaseError as error:
            refusal = error
        refusal = next((found for found in self._comm.allgather(refusal) if found), None)
        if refusal is not None:
            raise refusal


def header_to_restart_from(case: Case, checkpoint: Checkpoint) -> dict[str, Any] | None:
    """Return the header of the checkpoint of a case, None if its run never came so far; collective.

    Raises:
        CaseError: the checkpoint is damaged, lost or of a case that has changed; on all ranks.
    """
    header = checkpoint.read_header()
    if header is not None:
        checked(header, str(checkpoint.path))
        refuse_changes(header["case"], case.content, str(checkpoint.path))
        return header
    folder = case.output.folder
    record = record_of(folder)
    if record is not None and record.get("time_reached", 0.0) > 0.0:
        raise CaseError(
            f"{folder} holds results, but no checkpoint to go on from ({checkpoint.path} is "
            "missing); put it back, or run the case anew without --restart, which keeps these aside"
        )
    log.info("there is no checkpoint in %s yet: starting from the beginning", folder)
    return None
