"""Runs in meshes that follow the errors of the run before."""

from __future__ import annotations

from itertools import pairwise

import pytest

from castx.command.beside import adapted
from castx.command.beside.adapted import adapted_table, run_adapted
from castx.command.cli import execute
from castx.command.run import RunSettings, asked_case
from castx.errors import ConvergenceError
from castx.results.reading import Results
from tests.castx.command.beside.two_blocks import two_blocks_case


def cells(folder) -> int:
    return sum(body["cells"] for body in Results(folder).record["bodies"].values())


def flux_error(folder) -> float:
    """Return the error of the heat flux of both bodies in norms of energy."""
    found = Results(folder).record["flux_errors"]
    return (
        sum(
            found[body]["error"] ** 2 * volume / conductivity
            for body, volume, conductivity in (("casting", 4.0, 237.0), ("die", 6.0, 25.0))
        )
        ** 0.5
    )


@pytest.mark.ranks
def test_each_mesh_has_twice_the_cells_and_smaller_errors(comm, shared_tmp_path, said):
    case, folder = two_blocks_case(comm, shared_tmp_path), shared_tmp_path / "out"
    assert execute(["run", str(case), "--output", str(folder), "--adapt", "2"], comm) == 0
    text = said()
    runs = [folder, folder / "adapted_1", folder / "adapted_2"]
    assert all((folder / f"sizes_{count}.vtu").is_file() for count in (1, 2))
    counts, errors = [cells(run) for run in runs], [flux_error(run) for run in runs]
    for before, after in pairwise(counts):
        assert 1.5 * before < after < 3.0 * before
    assert errors[1] < errors[0] and errors[2] < 0.85 * errors[1]
    assert all(f"{count} cells" in text for count in counts) or comm.rank
    assert "last change" in text or comm.rank


@pytest.mark.serial
def test_a_mesh_that_does_not_converge_has_none_behind_it(comm, tmp_path, monkeypatch):
    case, folder = two_blocks_case(comm, tmp_path), tmp_path / "out"
    solved = adapted.run_beside.__globals__["run_case"]

    def failing(case, *others):
        if case.output.folder.name == "adapted_1":
            solved(case, *others)
            record = case.output.folder / "run.json"
            record.write_text(record.read_text().replace('"finished"', '"not converged"'))
            raise ConvergenceError("no")
        return solved(case, *others)

    monkeypatch.setitem(adapted.run_beside.__globals__, "run_case", failing)
    run_adapted(asked_case(case, (), folder), RunSettings(comm), rounds=3)
    assert (folder / "adapted_1").is_dir() and not (folder / "adapted_2").exists()
    assert [column.header for column in adapted_table(folder).columns][-1] == "last change"


@pytest.mark.serial
def test_results_in_meshes_of_an_earlier_run_are_kept_aside(comm, tmp_path):
    case, folder = two_blocks_case(comm, tmp_path), tmp_path / "out"
    short = ["time.end=0.5"]
    run_adapted(asked_case(case, short, folder), RunSettings(comm), rounds=2)
    run_adapted(asked_case(case, short, folder), RunSettings(comm), rounds=1)
    assert (folder / "adapted_2.1" / "run.json").is_file()
    assert len(adapted_table(folder).columns) == 4, "names, own mesh, one more, change"


def test_meshes_that_castx_does_not_make_of_cad_are_refused(comm, case_file, said):
    assert execute(["run", str(case_file), "--adapt", "1"], comm) == 2
    assert "--adapt meshes CAD parts again" in said() or comm.rank


def test_one_reason_for_runs_beside_a_run(comm, case_file, said):
    assert execute(["run", str(case_file), "--adapt", "1", "--estimate"], comm) == 2
    assert "take one" in said() or comm.rank
