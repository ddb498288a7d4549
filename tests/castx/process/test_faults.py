"""A fault on one rank of a run ends all of them soon, with one exit code and a word of why."""

from __future__ import annotations

import json
import sys
import time

import pytest

from tests.castx.command_line import CASE, start

pytestmark = pytest.mark.serial

LONGEST = 10.0
"""Time from the fault to the end of all ranks [s]."""

RUN = """
import sys, time
from pathlib import Path
from mpi4py import MPI
import castx.command.cli
from castx.checkpoint.chunks import ChunkedRows
from castx.mechanics.constitutive import response
from castx.heat.body import ThermalBody
from castx.errors import ConvergenceError
from castx.results import vtu_fields
from castx.results.gathered import GatheredBody

PLACES = {
    "heat": (ThermalBody, "conducted_heat"),
    "law": (response, "respond"),
    "pieces": (vtu_fields, "write_piece"),
    "gathered": (GatheredBody, "nodal"),
    "checkpoint": (ChunkedRows, "collected"),
}
FAULTS = {
    "bug": ZeroDivisionError("a fault"),
    "no convergence": ConvergenceError("a fault"),
    "disk": OSError(28, "a fault"),
}
place, fault = sys.argv[1:3]
owner, name = PLACES[place]
whole, calls = getattr(owner, name), []

def faulty(*arguments):
    calls.append(time.time())
    if MPI.COMM_WORLD.rank == MPI.COMM_WORLD.size - 1 and len(calls) > 3:
        Path("fault").write_text(str(calls[3]))
        raise FAULTS[fault]
    return whole(*arguments)

setattr(owner, name, faulty)
sys.argv[1:] = sys.argv[3:]
castx.command.cli.main()
"""


@pytest.mark.sampled
@pytest.mark.parametrize(
    "ranks, place, fault, text",
    [
        (2, "heat", "bug", "ZeroDivisionError: a fault"),
        (3, "heat", "no convergence", "rank 2 has failed alone and ends the others: a fault"),
        (2, "law", "bug", "ZeroDivisionError: a fault"),
        (2, "pieces", "disk", "castx: cannot write results: a fault; what was written before"),
        (2, "gathered", "bug", "ZeroDivisionError: a fault"),
        (2, "checkpoint", "bug", "ZeroDivisionError: a fault"),
    ],
)
def test_a_fault_on_one_rank_ends_all_of_them(
    ranks, place, fault, text, tmp_path, monkeypatch
) -> None:
    (tmp_path / "run.py").write_text(RUN)
    output = '[output]\nevery = 0.05\ncheckpoint = 0.05\nfields = ["temperature"]\n'
    output += 'format = "vtu"\n' if place == "pieces" else ""
    (tmp_path / "case.toml").write_text(CASE + output)
    monkeypatch.chdir(tmp_path)
    process = start(
        "mpirun", "-n", str(ranks), sys.executable, "run.py", place, fault,
        "run", "case.toml", "--output", "out",
    )  # fmt: skip
    _, errors = process.communicate(timeout=60)
    ended = time.time()
    assert process.returncode == 1, errors
    assert text in " ".join(errors.split())
    assert ended - float((tmp_path / "fault").read_text()) < LONGEST
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert record["exit"]["reason"] in ("failed", "running")


DRIVER = """
import sys, time
from pathlib import Path
from mpi4py import MPI
import castx

FAULTS = {
    "exits": lambda gap: sys.exit(3),
    "negative": lambda gap: -1.0 - gap,
}
fault = FAULTS[sys.argv[1]]

def law(gap, pressure, secondary, primary, time_of_run):
    if time_of_run > 0.1 and MPI.COMM_WORLD.rank == MPI.COMM_WORLD.size - 1:
        Path("fault").write_text(str(time.time()))
        return fault(gap)
    return 1.0 / (1.0 / 2300.0 + gap / 0.05)

case = castx.load_case("case.toml")
laws = {"casting/mould": castx.UserLaw(law)}
for state in castx.Simulation.from_case(case, MPI.COMM_WORLD, laws):
    pass
"""


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("fault", "text"),
    [
        ("negative", "CaseError: a heat-transfer coefficient must be finite and not negative"),
        ("exits", "SystemExit: 3"),
    ],
)
def test_a_law_of_a_driver_that_fails_on_one_rank_ends_all_of_them(
    fault, text, tmp_path, monkeypatch
):
    (tmp_path / "driver.py").write_text(DRIVER)
    (tmp_path / "case.toml").write_text(CASE)
    monkeypatch.chdir(tmp_path)
    process = start("mpirun", "-n", "2", sys.executable, "driver.py", fault)
    _, errors = process.communicate(timeout=60)
    ended = time.time()
    assert process.returncode != 0
    assert "rank 1 has failed alone and ends the others" in errors
    assert text in " ".join(errors.split())
    assert ended - float((tmp_path / "fault").read_text()) < LONGEST
