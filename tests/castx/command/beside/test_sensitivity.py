"""Runs with another coherency beside a run."""

from __future__ import annotations

import numpy as np
import pytest

from castx.command.beside.sensitivity import run_sensitivity, sensitivity_table
from castx.command.cli import execute
from castx.command.run import RunSettings, asked_case, run
from castx.errors import CaseError, ConvergenceError
from castx.report.summary.registry import findings
from castx.results.files.sensitivity import read_sensitivity
from castx.results.reading import Results
from tests.castx import command_line

MOULD = "casting/mould"
THIN = [  # the skin freezes within a second, and what follows hangs on the mush
    'geometry.radius="4 mm"', 'geometry.height="8 mm"', 'geometry.wall="4 mm"',
    'geometry.size="2 mm"', "time.end=8", "time.largest_step=0.5", "time.temperature_change=200",
]  # fmt: skip


@pytest.fixture
def alloy_file(comm, shared_tmp_path):
    path = shared_tmp_path / "alloy.toml"
    if comm.rank == 0:
        path.write_text(command_line.ALLOY_CASE)
    comm.Barrier()
    return path


def setting(coherency):
    liquid = f"{{viscosity=1e6, coherency={coherency}}}"
    return f'materials.AlSi7Mg={{extends="AlSi7Mg", liquid={liquid}}}'


@pytest.mark.slow
@pytest.mark.ranks
def test_the_runs_are_those_of_their_coherency(comm, alloy_file, shared_tmp_path, said):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(alloy_file), "--output", str(folder), "--sensitivity", "coherency"]
    assert execute([*arguments, *(part for one in THIN for part in ("--set", one))], comm) == 0
    text = said()
    found = read_sensitivity(folder)
    assert [run.coherency["casting"] for run in found.runs] == pytest.approx([0.85, 0.9, 0.95])
    assert [run.folder for run in found.runs] == ["coherency_lower", ".", "coherency_higher"]
    for varied in (found.runs[0], found.runs[2]):
        coherency = varied.coherency["casting"]
        own = run(
            alloy_file, [*THIN, setting(coherency)], comm=comm,
            output=shared_tmp_path / f"own{coherency:.2f}",
        )  # fmt: skip
        one, two = Results(own), Results(folder / varied.folder)
        for column in ("casting.solid_fraction", f"{MOULD}.max_gap"):
            np.testing.assert_allclose(two.history[column], one.history[column], 1e-9, 1e-15)
        solid = np.flatnonzero(one.history["casting.solid_fraction"] > 1.0 - 1e-9)
        assert varied.frozen["casting"] == pytest.approx(one.history["time"][solid[0]])
        widest = np.nanmax(one.history[f"{MOULD}.max_gap"])
        assert varied.gaps[MOULD] == pytest.approx(widest, rel=1e-9)
        assert varied.freezing_text("casting") in text and varied.gap_text(MOULD) in text
        comm.Barrier()
    assert len(set(found.runs[i].gaps[MOULD] for i in range(3))) == 3
    (gap,) = (f for f in findings(Results(folder)) if f.topic == "Largest gap by coherency")
    widths = [varied.gaps[MOULD] for varied in found.runs]
    assert gap.value == max(widths) - min(widths)


@pytest.mark.ranks
def test_a_case_without_coherency_is_refused_before_it_is_run(
    comm, case_file, shared_tmp_path, said
):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder), "--sensitivity", "coherency"]
    assert execute(arguments, comm) == 2
    assert "case.toml: no body has a coherency" in said()
    assert not folder.exists()


def test_another_name_is_refused(comm, case_file, said):
    assert execute(["run", str(case_file), "--sensitivity", "viscosity"], comm) == 2
    assert "coherency" in said()


def test_one_that_cannot_rise_is_run_lower_alone(comm, alloy_file, shared_tmp_path):
    short = [*THIN, "time.end=0.25", setting(1.0)]
    folder = run_sensitivity(
        asked_case(alloy_file, short, shared_tmp_path / "out"), RunSettings(comm)
    )
    runs = read_sensitivity(folder).runs
    assert [found.coherency["casting"] for found in runs] == [0.95, 1.0]
    assert runs[0].frozen == {"casting": None} and runs[0].reached == 0.25


def test_another_run_that_fails_is_said_in_its_row(comm, alloy_file, shared_tmp_path, monkeypatch):
    from castx.command.beside import runs

    def failing(case, *others):
        found = sensitivity_run(case, *others)
        if case.output.folder.name == "coherency_lower":
            raise ConvergenceError("no solution")
        return found

    sensitivity_run = runs.run_case
    monkeypatch.setattr(runs, "run_case", failing)
    short = [*THIN, "time.end=0.25"]
    folder = run_sensitivity(
        asked_case(alloy_file, short, shared_tmp_path / "out"), RunSettings(comm)
    )
    assert len(read_sensitivity(folder).runs) == 3


@pytest.mark.ranks
def test_a_restart_goes_on_with_all_of_them(comm, alloy_file, shared_tmp_path):
    folder = shared_tmp_path / "out"
    short = [*THIN, "time.end=0.5"]
    run(alloy_file, short, output=folder, comm=comm)
    longer = [*THIN, "time.end=1"]
    run_sensitivity(asked_case(alloy_file, longer, folder), RunSettings(comm, restart=True))
    assert [found.reached for found in read_sensitivity(folder).runs] == [1.0, 1.0, 1.0]


@pytest.mark.serial
def test_a_folder_without_them_has_no_table(tmp_path):
    with pytest.raises(CaseError, match="no runs with another coherency"):
        sensitivity_table(tmp_path)
