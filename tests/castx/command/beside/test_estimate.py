"""Runs in a coarser mesh and in larger steps beside a run."""

from __future__ import annotations

import pytest

from castx.command.beside.estimate import MESH, STEPS, estimate_table, run_estimate
from castx.command.cli import execute
from castx.command.run import RunSettings, asked_case, run
from castx.errors import CaseError
from castx.report.summary.registry import findings
from castx.results.files.estimate import read_estimate
from castx.results.reading import Results

GAP = "Largest gap: casting/mould"
FINE = ["geometry.size=2.5e-3", "time.end=6", "time.largest_step=0.5"]
COARSE_MESH = ["geometry.size=5e-3", *FINE[1:]]
LARGE_STEPS = [
    "time.first_step=0.1", "time.largest_step=1.0", "time.temperature_change=40",
    "time.solid_fraction_change=0.08", "time.skin_change=0.2", *FINE[:2],
]  # fmt: skip


def largest_gap(folder):
    (found,) = (f for f in findings(Results(folder)) if f.name == GAP)
    return found.value


@pytest.mark.slow
@pytest.mark.ranks
def test_errors_come_from_runs_of_their_own(comm, case_file, shared_tmp_path, said):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder), "--estimate"]
    assert execute([*arguments, *(part for one in FINE for part in ("--set", one))], comm) == 0
    text, found = said(), read_estimate(folder)
    own = {
        name: largest_gap(run(case_file, keys, comm=comm, output=shared_tmp_path / name))
        for name, keys in ((MESH, COARSE_MESH), (STEPS, LARGE_STEPS))
    }
    assert found.mesh.folder == MESH and found.steps.folder == STEPS
    assert found.mesh.values[GAP] == pytest.approx(own[MESH], rel=1e-9)
    assert found.steps.values[GAP] == pytest.approx(own[STEPS], rel=1e-9)
    assert found.steps.ratio == 2.0 and 1.8 < found.mesh.ratio < 2.2
    (gap,) = (f for f in findings(Results(folder)) if f.name == GAP)
    assert gap.value not in own.values()
    by_mesh, _ = found.changes(GAP)
    assert by_mesh == pytest.approx((gap.value - own[MESH]) / (found.mesh.ratio - 1.0))
    assert "by the mesh" in gap.error and "by the steps" in gap.error
    assert gap.number in text and f"{abs(1e6 * by_mesh):.2g} µm" in text


def test_a_step_that_never_counts_changes_nothing(comm, case_file, shared_tmp_path):
    """The estimate of a run in equal steps, one large one, is that of its mesh alone."""
    one = ["time.end=0.1", "time.fixed_step=0.1", "time.first_step=0.1"]
    folder = run_estimate(asked_case(case_file, one, shared_tmp_path / "out"), RunSettings(comm))
    found = read_estimate(folder)
    assert found.steps.values == pytest.approx(found.values, rel=1e-12)
    assert found.mesh.values != pytest.approx(found.values, rel=1e-3)


def test_two_kinds_of_runs_beside_a_run_are_refused(comm, case_file, said):
    arguments = ["run", str(case_file), "--estimate", "--sensitivity", "coherency"]
    assert execute(arguments, comm) == 2
    assert "take one" in said()


@pytest.mark.serial
def test_a_folder_without_them_has_no_table(tmp_path):
    with pytest.raises(CaseError, match="no runs in a coarser mesh"):
        estimate_table(tmp_path)
