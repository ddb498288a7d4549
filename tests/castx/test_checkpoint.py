"""Runs that go on from a checkpoint end like those that were not interrupted."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from castx.checkpoint import Checkpoint
from castx.errors import CaseError
from tests.coupled_cases import (
    TIGHT,
    cylinder,
    fields,
    largest_difference,
    merged,
    ring,
    simulation,
)

LIQUID = {"model": "viscous", "viscosity": 1e6, "coherency": 0.6}
FLOWING = {
    "materials": {
        "aluminium": {
            "solidus": 640.0,
            "liquid": LIQUID,
            "yield_stress": [[20.0, 60e6], [640.0, 1e6]],
            "hardening": 500e6,
            "viscosity": 1e8,
        }
    }
}
SHORT = {"time": {"end": 3.0, "first_step": 0.2, "largest_step": 0.5}}


def with_law(law: str, **casting: Any) -> dict[str, Any]:
    """Return the cylinder with a casting that freezes from a liquid and flows."""
    data = cylinder(SHORT, FLOWING)
    data["bodies"][0] |= {"law": law, **casting}
    return data


def thermal() -> dict[str, Any]:
    return cylinder(SHORT, {"coupling": {"scheme": "thermal"}})


def prescribed() -> dict[str, Any]:
    data = merged(ring(), {"coupling": {"scheme": "mechanical"}, "time": SHORT["time"]})
    data["bodies"][0]["temperature_history"] = [[0.0, 650.0], [3.0, 300.0]]
    return data


def elastic(method: str) -> dict[str, Any]:
    """Return the cylinder with a contact method, born from a liquid."""
    return cylinder(SHORT, {"materials": {"aluminium": {"liquid": LIQUID}}}, method=method)


METHODS = ("condensed", "multipliers", "penalty", "augmented-lagrangian", "tied", "block-iterative")
CASES = {method: elastic(method) for method in METHODS} | {
    "elasto-plastic": with_law("thermo-elasto-plastic"),
    "viscoplastic": with_law("thermo-elasto-viscoplastic"),
    "thermal": thermal(),
    "prescribed": prescribed(),
    "quadrilaterals": merged(
        with_law("thermo-elasto-viscoplastic"), {"geometry": {"cells": "quadrilaterals"}}
    ),
    "closing": ring({"time": {"end": 4.0, "largest_step": 0.5}}),
}

IN_PARALLEL = ("condensed", "multipliers", "viscoplastic")


def run_with_checkpoint(comm, data: Mapping[str, Any], folder, at: int):
    """Run a case, with a checkpoint behind a step; return the last fields and totals."""
    run = simulation(comm, data)
    checkpoint = Checkpoint(folder, comm)
    for state in run:
        if state.step == at:
            checkpoint.write(run.saved(), {})
    found = (state.step, fields(state), dict(state.totals))
    run.destroy()
    return found


def run_from_checkpoint(comm, data: Mapping[str, Any], folder):
    run = simulation(comm, data)
    checkpoint = Checkpoint(folder, comm)
    header = checkpoint.read_header()
    assert header is not None
    run.restore(checkpoint.read(header, run.saved()))
    steps = [state.step for state in run]
    state = run.state()
    found = (steps, fields(state), dict(state.totals))
    run.destroy()
    return found


def difference(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[float, str]:
    """Return the largest difference; gaps, which may all be closed, in units of the motions."""
    both = [
        {name.replace(" gap", " displacement"): values for name, values in fields.items()}
        for fields in (a, b)
    ]
    return largest_difference(*both)


@pytest.mark.parametrize("name", CASES)
def test_runs_go_on_from_a_checkpoint(name, comm, shared_tmp_path):
    if comm.size > 1 and name not in IN_PARALLEL:
        pytest.skip("on one rank only")
    # Sums of several ranks differ in the last digits from run to run.
    data = CASES[name] if comm.size == 1 else merged(CASES[name], TIGHT)
    last, whole, totals = run_with_checkpoint(comm, data, shared_tmp_path, 3)
    steps, found, found_totals = run_from_checkpoint(comm, data, shared_tmp_path)
    assert steps == list(range(4, last + 1))
    largest, where = difference(found, whole)
    assert largest < 1e-10, where
    for key, value in totals.items():
        # Errors and forces that should be zero are round-off.
        assert found_totals[key] == pytest.approx(value, rel=1e-9, abs=1e-7), key
    if comm.size > 1:
        steps, found = run_on_part(comm, data, shared_tmp_path)
        assert steps == list(range(4, last + 1))
        largest, where = difference(found, whole)
        assert largest < 1e-6, where


def run_on_part(comm, data: Mapping[str, Any], folder):
    """Go on with rank 0 alone, and the others with a copy of the checkpoint of all."""
    own = folder / str(int(comm.rank > 0))
    part = comm.Split(int(comm.rank > 0), comm.rank)
    if part.rank == 0:
        shutil.copytree(folder / "checkpoint", own / "checkpoint")
    part.Barrier()
    steps, found, _ = run_from_checkpoint(part, data, own)
    part.Free()
    return steps, found


def test_a_checkpoint_that_cannot_be_written_leaves_the_old_one(comm, shared_tmp_path, monkeypatch):
    run = simulation(comm, thermal())
    checkpoint = Checkpoint(shared_tmp_path, comm)
    checkpoint.write(run.saved(), {"which": "old"})

    def no_space(file, array, **_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np.lib.format, "write_array", no_space)
    with pytest.raises(Exception, match=r"No space left on device.*--restart"):
        checkpoint.write(run.saved(), {"which": "new"})
    monkeypatch.undo()
    run.destroy()
    header = checkpoint.read_header()
    assert header is not None and header["which"] == "old"
    comm.Barrier()
    assert [path.name for path in (shared_tmp_path / "checkpoint").iterdir()] == ["state.npz"]


@pytest.mark.parametrize("damage", ["cut", "flip", "empty"])
def test_damaged_checkpoints_are_refused(damage, comm, shared_tmp_path):
    checkpoint = Checkpoint(shared_tmp_path, comm)
    run = simulation(comm, thermal())
    checkpoint.write(run.saved(), {})
    run.destroy()
    if comm.rank == 0:
        content = checkpoint.path.read_bytes()
        middle = len(content) // 2
        spoilt = {
            "cut": content[:middle],
            "flip": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
            "empty": b"",
        }
        checkpoint.path.write_bytes(spoilt[damage])
    comm.Barrier()
    with pytest.raises(CaseError, match=r"state\.npz is damaged.*without --restart"):
        checkpoint.read_header()
