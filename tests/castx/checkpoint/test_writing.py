"""When checkpoints are written, and which of them a run goes on from."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from castx.checkpoint.file import Checkpoint
from castx.checkpoint.writing import Checkpoints, header_to_restart_from
from castx.errors import CaseError, ConvergenceError, Interrupted
from castx.stateful import Saved


class FakeSimulation:
    """Remembers one number."""

    def __init__(self, comm, digest: str = "mesh") -> None:
        self.mesh = SimpleNamespace(comm=comm, digest=digest)
        self.time, self.step, self.value = 0.0, 0, 0.0
        self.prepared: dict = {}

    def saved(self) -> dict[str, Saved]:
        numbers = {"value": self.value, "time": self.time, "step": self.step}
        return {name: Saved(np.array(float(number))) for name, number in numbers.items()}

    def notes(self) -> dict:
        return {"phase": 3}

    def prepare(self, notes) -> None:
        self.prepared = notes

    def restore(self, arrays) -> None:
        self.value, self.time = float(arrays["value"]), float(arrays["time"])
        self.step = int(arrays["step"])

    def state(self) -> SimpleNamespace:
        return SimpleNamespace(value=self.value)


class FakeResults:
    """Has nothing to save and counts what it is asked to write."""

    def __init__(self) -> None:
        self.pending, self.synced, self.resumed, self.begun = 0, 0, None, None

    def saved(self) -> dict[str, Saved]:
        return {}

    def notes(self) -> dict:
        return {"rows": 5}

    def write_pending(self) -> None:
        self.pending += 1

    def sync(self) -> None:
        self.synced += 1

    def resume(self, arrays, notes, state) -> None:
        self.resumed, self.begun = notes, state.value


def case_of(folder: Path, every: float | None = None) -> SimpleNamespace:
    output = SimpleNamespace(checkpoint=every, folder=folder)
    return SimpleNamespace(output=output, content={"time": {"end": 5.0}})


def checkpoints(comm, folder, every=None, digest="mesh"):
    simulation, results = FakeSimulation(comm, digest), FakeResults()
    file = Checkpoint(folder, comm)
    return Checkpoints(file, case_of(folder, every), simulation, results), simulation, results, file


def written_at(file: Checkpoint) -> float | None:
    header = file.read_header()
    return None if header is None else header["time"]


def test_the_initial_state_and_each_multiple_of_the_interval_are_written(comm, shared_tmp_path):
    writing, simulation, _, file = checkpoints(comm, shared_tmp_path, every=1.0)
    found = []
    for time in (0.0, 0.4, 0.9, 0.1 + 0.2 + 0.7, 1.7, 2.3, 4.1, 4.2):
        simulation.time = time
        writing.write_when_due()
        found.append(written_at(file))
    assert found == [0.0, 0.0, 0.0, 1.0, 1.0, 2.3, 4.1, 4.1]


@pytest.mark.ranks
def test_by_default_the_wall_clock_decides(comm, shared_tmp_path, monkeypatch):
    """After a minute, and never so often that writing takes more than a twentieth of the time."""
    now = {"clock": 0.0}
    monkeypatch.setattr("castx.checkpoint.writing.clock.monotonic", lambda: now["clock"])
    writing, simulation, _, file = checkpoints(comm, shared_tmp_path)
    writing.write_when_due()
    for clock, time, expected in ((59.0, 1.0, 0.0), (61.0, 2.0, 2.0), (100.0, 3.0, 2.0)):
        now["clock"], simulation.time = clock, time
        writing.write_when_due()
        assert written_at(file) == expected


@pytest.mark.ranks
@pytest.mark.parametrize(
    "ending, is_written",
    [
        (None, True),
        (ConvergenceError("no solution"), True),
        (Interrupted("stopped"), True),
        (ZeroDivisionError(), False),  # it may have struck one rank alone
    ],
)
def test_the_end_is_written_when_all_ranks_have_come_to_it(
    comm, shared_tmp_path, ending, is_written
):
    writing, _, results, file = checkpoints(comm, shared_tmp_path)
    writing.__enter__()
    writing.__exit__(None if ending is None else type(ending), ending, None)
    assert (file.read_header() is not None) == is_written
    assert results.pending == results.synced == int(is_written)


@pytest.mark.ranks
def test_a_run_goes_on_with_what_was_saved(comm, shared_tmp_path):
    writing, simulation, _, _ = checkpoints(comm, shared_tmp_path)
    simulation.time, simulation.value = 2.5, 7.0
    writing.write()
    later, again, results, file = checkpoints(comm, shared_tmp_path)
    header = file.read_header()
    assert (header["time"], header["ranks"]) == (2.5, comm.size)
    later.restore(header)
    assert (again.value, again.prepared, results.resumed) == (7.0, {"phase": 3}, {"rows": 5})
    assert results.begun == 7.0, "what is saved comes before the state that results go on from"


def test_another_mesh_is_refused(comm, shared_tmp_path):
    checkpoints(comm, shared_tmp_path)[0].write()
    later, _, _, file = checkpoints(comm, shared_tmp_path, digest="finer")
    with pytest.raises(CaseError, match=r"the mesh is not the one of .*state\.npz"):
        later.restore(file.read_header())


def test_an_array_of_the_simulation_that_is_missing_is_refused(comm, shared_tmp_path):
    checkpoints(comm, shared_tmp_path)[0].write()
    later, simulation, _, file = checkpoints(comm, shared_tmp_path)
    simulation.saved = lambda: {"new": Saved(np.array(1.0))}
    with pytest.raises(CaseError, match=r"was written by castx .* and lacks simulation/new"):
        later.restore(file.read_header())


@pytest.mark.parametrize("moment", [(float("nan"), 3), (1.5, -7), (-3.0, 3)])
def test_a_state_of_another_moment_than_its_header_is_refused(
    comm, shared_tmp_path, monkeypatch, moment
):
    writing, simulation, _, _ = checkpoints(comm, shared_tmp_path)
    simulation.time, simulation.step = 1.5, 3
    writing.write()
    later, again, results, file = checkpoints(comm, shared_tmp_path)

    def restore(arrays):
        again.time, again.step = moment

    monkeypatch.setattr(again, "restore", restore)
    with pytest.raises(
        CaseError, match=r"is damaged: its state is of t = .*, its header of t = 1.5"
    ):
        later.restore(file.read_header())
    assert results.resumed is None


def test_without_checkpoint_and_results_a_run_starts_from_the_beginning(comm, shared_tmp_path):
    case = case_of(shared_tmp_path)
    assert header_to_restart_from(case, Checkpoint(shared_tmp_path, comm)) is None


def test_results_without_their_checkpoint_are_refused(comm, shared_tmp_path):
    if comm.rank == 0:
        (shared_tmp_path / "run.json").write_text('{"castx": "1", "time_reached": 2.0}')
    comm.Barrier()
    with pytest.raises(CaseError, match="holds results, but no checkpoint to go on from"):
        header_to_restart_from(case_of(shared_tmp_path), Checkpoint(shared_tmp_path, comm))


@pytest.mark.ranks
@pytest.mark.parametrize("fault", [KeyError("rows"), TypeError("text"), ValueError("shape")])
def test_notes_that_do_not_fit_are_refused_in_words(comm, shared_tmp_path, monkeypatch, fault):
    checkpoints(comm, shared_tmp_path)[0].write()
    later, simulation, _, file = checkpoints(comm, shared_tmp_path)

    def fail(notes):
        raise fault

    monkeypatch.setattr(simulation, "prepare", fail)
    with pytest.raises(CaseError, match=r"is damaged: its header does not fit .*anew without"):
        later.restore(file.read_header())


@pytest.mark.serial
def test_a_checkpoint_of_another_version_says_so(comm, shared_tmp_path, caplog):
    checkpoints(comm, shared_tmp_path)[0].write()
    later, _, _, file = checkpoints(comm, shared_tmp_path)
    later.restore({**file.read_header(), "castx": "0.0.7"})
    assert "the checkpoint is of castx 0.0.7, this is" in caplog.text
