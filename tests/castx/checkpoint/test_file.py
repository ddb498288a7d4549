"""Checkpoints on any number of ranks: runs that go on from one, and its file."""

from __future__ import annotations

import gc
import resource
import shutil
import sys
import tracemalloc
from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.checkpoint import archive, chunks
from castx.checkpoint.file import Checkpoint
from castx.errors import CaseError, StorageError
from castx.materials.inelastic import FLOW_RULES
from castx.stateful import Numbering, Saved
from tests.castx.checkpoint.test_chunks import dealt
from tests.contact_methods import BETWEEN_DEFORMABLE
from tests.coupled_cases import (
    TIGHT,
    cylinder,
    fields,
    largest_difference,
    merged,
    ring,
    simulation,
)

pytestmark = pytest.mark.sampled

LIQUID = {"model": "viscous", "viscosity": 1e6, "coherency": 0.6}
CREEPING_LIQUID = {
    "model": "norton", "coefficient": 1e-12, "exponent": 2.0, "activation_energy": 1e4,
    "coherency": 0.6,
}  # fmt: skip
YIELDING = {"yield_stress": [[20.0, 60e6], [640.0, 1e6]], "hardening": 500e6}
LAWS = ("thermo-elastic", "thermo-elasto-plastic", "thermo-elasto-viscoplastic")
FLOWS: dict[str, dict[str, Any]] = {
    "power": {"law": "perzyna", "viscosity": 1e9, "exponent": 3.0, **YIELDING},
    "voce": {
        "viscosity": 1e8, **YIELDING,
        "hardening": {"linear": 100e6, "saturation": 20e6, "rate": 50.0},
    },
    "kinematic": {"viscosity": 1e8, **YIELDING, "kinematic_hardening": 1e9},
    "creeping liquid": {"viscosity": 1e8, **YIELDING, "liquid": CREEPING_LIQUID},
}  # fmt: skip
FLOWS |= {
    name: {"law": name, **rule.example, **(YIELDING if rule.threshold else {})}
    for name, rule in FLOW_RULES.items()
}
SHORT = {"time": {"end": 3.0, "first_step": 0.2, "largest_step": 0.5}}


def casting(
    law: str, method: str = "condensed", flow: Mapping[str, Any] | None = None, **contact: Any
) -> dict[str, Any]:
    """Return the cylinder with a casting that freezes from a liquid and obeys a law."""
    material: dict[str, Any] = {"liquid": LIQUID}
    if law != "thermo-elastic":
        material |= {"solidus": 640.0, **YIELDING}
    if law == "thermo-elasto-viscoplastic":
        material |= {"viscosity": 1e8}
    if flow is not None:
        material = {"liquid": LIQUID, "solidus": 640.0, **flow}
    data = cylinder(SHORT, {"materials": {"aluminium": material}}, method=method)
    data["bodies"][0]["law"] = law
    data["interfaces"][0]["contact"] |= contact
    return data


def flowing(*changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the cylinder whose metal flows viscously, with changes."""
    return merged(casting("thermo-elasto-viscoplastic"), dict(*changes))


def thermal() -> dict[str, Any]:
    return cylinder(SHORT, {"coupling": {"scheme": "thermal"}})


def prescribed() -> dict[str, Any]:
    data = merged(ring(), {"coupling": {"scheme": "mechanical"}, "time": SHORT["time"]})
    data["bodies"][0]["temperature_history"] = [[0.0, 650.0], [3.0, 300.0]]
    return data


def rigid(law: str) -> dict[str, Any]:
    """Return the cylinder in a mould that does not give way, and its method."""
    data = casting(law, "rigid")
    data["bodies"][1] = {"name": "mould", "material": "steel", "temperature": 200.0, "law": "rigid"}
    data["boundaries"] = data["boundaries"][:1]
    return data


def boxed(model: str) -> dict[str, Any]:
    """Return a heavy plane casting in a box, whose metal flows."""
    data = casting(LAWS[2])
    data["geometry"] = {
        "generator": "box_in_mould", "model": model, "box": [0.04, 0.03], "wall": 0.02,
        "size": 0.006,
    }  # fmt: skip
    data["boundaries"] = [{"on": "mould/base", "displacement": {"all": 0.0}}]
    data["loads"] = {"gravity": [-50.0, -80.0, 0.0]}  # into a corner: nothing floats
    return data


def quadratic() -> dict[str, Any]:
    """Return the cylinder whose casting has quadratic displacements and leaves its mould."""
    data = flowing()
    data["bodies"][0]["formulation"] = "taylor-hood"
    return data


def hanging() -> dict[str, Any]:
    """Return the cylinder in a mould with a floor, off which it comes and hangs on its in-gate."""
    data = merged(
        casting(LAWS[2]), {"geometry": {"floor": 0.02}, "support": {"in_gate": ["casting/top"]}}
    )
    data["boundaries"] = [{"on": "mould/base", "displacement": {"normal": 0.0}}]
    return data


def solid_sheet() -> dict[str, Any]:
    """Return a ring that never melts and yields round a core in plane stress."""
    data = ring({"time": SHORT["time"]}, model="plane-stress")
    data["materials"]["aluminium"] = {**data["materials"]["aluminium"], **YIELDING}
    data["bodies"][0] |= {"law": LAWS[1], "formulation": "displacement", "temperature": 400.0}
    data["boundaries"] = data["boundaries"][2:]
    return data


def sticking(method: str) -> dict:
    """Return a ring that shrinks onto a core and slides on it, with friction.

    A first solve has no factors yet and iterates otherwise, so that both runs are solved tightly.
    """
    data = ring({"time": {"end": 4.0, "largest_step": 0.5}}, TIGHT)
    data["interfaces"][0]["contact"] = {"method": method, "friction": 0.2}
    return data


CASES = (
    {f"{method}, {law}": casting(law, method) for method in BETWEEN_DEFORMABLE for law in LAWS}
    | {f"rigid, {law}": rigid(law) for law in LAWS}
    | {name: casting(LAWS[2], flow=flow) for name, flow in FLOWS.items()}
    | {
        "augmented in the iteration": casting(
            LAWS[2], "augmented-lagrangian", augmentation="iteration"
        ),
        "interface as a block": casting(LAWS[0], "block-iterative", blocks="interface"),
        "blocks as a preconditioner": casting(
            LAWS[2], "block-iterative", block_solver="preconditioner"
        ),
        "fallback": casting(LAWS[0], "block-iterative", fallback=["condensed"]),
        "in-gate": hanging(),
        "patches": casting(LAWS[2], normals="patches"),
        "thermal": thermal(),
        "mechanical": prescribed(),
        "quadrilaterals": flowing({"geometry": {"cells": "quadrilaterals"}}),
        "quadratic": quadratic(),
        "staggered": flowing({"coupling": {"scheme": "staggered"}}),
        "closing": ring({"time": {"end": 4.0, "largest_step": 0.5}}),
        "friction": sticking("condensed"),
        "friction by a penalty": sticking("penalty"),
        "plane stress": solid_sheet(),
        "plane strain": boxed("plane-strain"),
        "generalised plane strain": boxed("generalised-plane-strain"),
    }
)

IN_PARALLEL = (
    "condensed, thermo-elasto-viscoplastic",
    "multipliers, thermo-elasto-plastic",
    "penalty, thermo-elastic",
    "augmented-lagrangian, thermo-elastic",
    "rigid, thermo-elasto-plastic",
    "quadratic",
    "thermal",
    "mechanical",
)


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


NO_PRESSURE = 1e-3
"""Contact pressure below which it is round-off of the stresses [Pa]."""


def difference(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[float, str]:
    """Return the largest difference; gaps, which may all be closed, in units of the motions."""
    both = [
        {
            name.replace(" gap", " displacement"): np.where(np.abs(values) < NO_PRESSURE, 0, values)
            if name.endswith(" contact_pressure")
            else values
            for name, values in fields.items()
        }
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


@pytest.mark.ranks
@pytest.mark.parametrize("rows", [chunks.ROWS, 7])
def test_files_and_what_is_read_do_not_depend_on_the_ranks(
    comm, shared_tmp_path, monkeypatch, rows
):
    """Also when one of them owns nothing, and for files of other numbers of ranks."""
    monkeypatch.setattr(chunks, "ROWS", rows)
    alone = dealt(MPI.COMM_SELF, 100)
    single = Checkpoint(shared_tmp_path / str(comm.rank), MPI.COMM_SELF)
    single.path.parents[1].mkdir()
    single.write(alone, {"which": "alone"})
    comm.Barrier()
    checkpoint = Checkpoint(shared_tmp_path, comm)
    for empty in (False, True):
        state = dealt(comm, 100, empty=empty)
        for written, header in ((state, "all"), (state, "alone")):
            checkpoint.write(written, {"which": header})
        assert checkpoint.path.read_bytes() == single.path.read_bytes()
        found = checkpoint.read({"arrays": list(state)}, state)
        for name, saved in state.items():
            assert found[name].dtype == saved.values.dtype
            np.testing.assert_array_equal(found[name], saved.values)
        comm.Barrier()
    # The ghosts of the last one are among the arrays of one rank, by their numbers.
    found = checkpoint.read({"arrays": ["rows"]}, dealt(comm, 100))
    order = np.sort(alone["rows"].numbering.numbers)
    with np.load(single.path) as opened:
        places = np.searchsorted(order, dealt(comm, 100)["rows"].numbering.numbers)
        np.testing.assert_array_equal(found["rows"], opened["rows"][places])


@pytest.mark.ranks
def test_a_rank_without_rows_need_not_know_their_shape(comm, shared_tmp_path):
    numbers, rows = np.arange(5), np.arange(10.0).reshape(5, 2)
    if comm.rank < comm.size - 1:
        numbers, rows = numbers[:0], np.empty((0, 1), dtype=np.float32)
    state = {"rows": Saved(rows, Numbering("cells", numbers, len(numbers), ("casting",)))}
    checkpoint = Checkpoint(shared_tmp_path, comm)
    checkpoint.write(state, {})
    with np.load(checkpoint.path) as opened:
        np.testing.assert_array_equal(opened["rows"], np.arange(10.0).reshape(5, 2))


@pytest.mark.ranks
def test_no_rank_holds_a_whole_array(comm, shared_tmp_path, monkeypatch):
    monkeypatch.setattr(chunks, "ROWS", 2**9)
    monkeypatch.setattr(archive, "PART", 2**16)
    state = dealt(comm, 2**15, width=30)
    checkpoint = Checkpoint(shared_tmp_path, comm)
    whole = 2**15 * 30 * 8
    tracemalloc.start()
    checkpoint.write(state, {})
    assert tracemalloc.get_traced_memory()[1] < 0.4 * whole
    tracemalloc.reset_peak()
    header = checkpoint.read_header()
    checkpoint.read(header, state)
    assert tracemalloc.get_traced_memory()[1] < (1.0 / comm.size + 0.4) * whole
    tracemalloc.stop()


def test_another_number_of_rows_is_refused(comm, shared_tmp_path):
    checkpoint = Checkpoint(shared_tmp_path, comm)
    checkpoint.write(dealt(comm, 100), {})
    with pytest.raises(CaseError, match=r"state\.npz has 100 rows of rows, and the case 99"):
        checkpoint.read({"arrays": ["rows"]}, dealt(comm, 99))


@pytest.fixture
def small_chunks(monkeypatch):
    """Let all ranks write, though the arrays are small."""
    monkeypatch.setattr(chunks, "ROWS", 16)


@pytest.mark.parametrize("limit", [100, 200_000])
@pytest.mark.usefixtures("small_chunks")
def test_a_checkpoint_that_cannot_be_written_leaves_the_old_one(
    comm, shared_tmp_path, monkeypatch, limit
):
    """The file of the last rank may not grow beyond some bytes: at values and behind them all."""
    run = simulation(comm, thermal())
    checkpoint = Checkpoint(shared_tmp_path, comm)
    checkpoint.write(run.saved(), {"which": "old"})
    ignored = []
    monkeypatch.setattr(sys, "unraisablehook", ignored.append)
    own, highest = resource.getrlimit(resource.RLIMIT_FSIZE)
    padding = {"padding": "x" * 200_000}  # of the header, which rank 0 writes behind all values
    if comm.rank == (comm.size - 1 if limit == 100 else 0):
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, highest))
    try:
        with pytest.raises(StorageError, match=r"state\.npz cannot.*File too large.*--restart"):
            checkpoint.write(run.saved(), padding)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (own, highest))
    gc.collect()
    run.destroy()
    assert not ignored
    header = checkpoint.read_header()
    assert header is not None and header["which"] == "old"
    comm.Barrier()
    assert [path.name for path in (shared_tmp_path / "checkpoint").iterdir()] == ["state.npz"]


@pytest.mark.ranks
@pytest.mark.parametrize("damage", ["cut", "flip", "empty"])
@pytest.mark.usefixtures("small_chunks")
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
