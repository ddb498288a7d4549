"""The command line: what it prints, and exit codes that are the same on all ranks."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import castx.command.run
from castx.command.cli import execute
from castx.errors import ConvergenceError

CASE = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = "20 mm"
height = "40 mm"
wall = "10 mm"
size = "5 mm"
[[bodies]]
name = "casting"
material = "Al-pure"
temperature = 670
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
formulation = "displacement"
[[interfaces]]
bodies = ["casting", "mould"]
heat = { law = "limited", closed = 2300, gas_conductivity = 0.05 }
[[boundaries]]
on = "casting/base"
displacement = { normal = 0 }
[[boundaries]]
on = "mould/base"
displacement = { normal = 0 }
[time]
end = 0.2
first_step = 0.05
largest_step = 0.1
"""


@pytest.fixture
def case_file(comm, shared_tmp_path):
    path = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        path.write_text(CASE)
    comm.Barrier()
    return path


def said(comm, capsys):
    """Return what rank 0 has printed, output and errors, with blanks instead of line ends."""
    captured = capsys.readouterr()
    return comm.bcast(" ".join((captured.out + captured.err).split()))


def test_a_run_leaves_its_results_and_says_where(comm, case_file, shared_tmp_path, capsys):
    folder = shared_tmp_path / "out"
    assert execute(["run", str(case_file), "--output", str(folder)], comm) == 0
    text = said(comm, capsys)
    assert "step 1" in text and f"done: {folder}" in text
    assert json.loads((folder / "run.json").read_text())["exit"]["reason"] == "finished"


def test_newton_iterations_are_shown_on_request(comm, case_file, shared_tmp_path, capsys):
    arguments = ["run", str(case_file), "--output", str(shared_tmp_path / "out"),
                 "--set", "time.end=0.05", "--set", "time.smallest_step=0.02"]  # fmt: skip
    assert execute([*arguments, "--log", "newton"], comm) == 0
    text = said(comm, capsys)
    assert "step of 0.05 s from 0 s" in text
    for name in ("the heat problem", "the mechanical equilibrium"):
        found = re.search(rf"{name}: converged [a-z ]+ after (\d+) iterations \((\d+) linear\), "
                          r"residuals ([-+.e\d, ]+)", text)  # fmt: skip
        assert found, text
        residuals = [float(value) for value in found[3].split(",")]
        assert len(residuals) == int(found[1]) + 1 and int(found[2]) >= int(found[1])
        assert residuals[-1] < 1e-2 * residuals[0]
    failing = [*arguments, "--log", "newton", "--set", "solver.mechanics.snes_max_it=0"]
    assert execute(failing, comm) == 3
    text = said(comm, capsys)
    assert "the mechanical equilibrium: diverged max it after 0 iterations" in text
    assert "step of 0.025 s from 0 s" in text
    assert execute(arguments, comm) == 0
    assert "residuals" not in said(comm, capsys)
    assert execute([*arguments, "--log", "everything"], comm) == 2
    assert "'everything' is not 'newton'" in said(comm, capsys)


def test_set_replaces_values(comm, case_file, shared_tmp_path, capsys):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder), "--set", "time.end=0.05"]
    assert execute(arguments, comm) == 0
    assert json.loads((folder / "run.json").read_text())["time_reached"] == 0.05


@pytest.mark.parametrize(
    "override, text",
    [
        ("bodies.0.material=Al-pur", "unknown material 'Al-pur'"),
        ("geometry.radius=-1", "must be positive"),
        ("time.ende=5", "unknown key"),
    ],
)
def test_a_refused_case_is_said_once_without_a_traceback(comm, case_file, capsys, override, text):
    assert execute(["check", str(case_file), "--set", override], comm) == 2
    output = said(comm, capsys)
    assert output.count(text) == 1 and "Traceback" not in output and "castx: " in output


def test_a_missing_surface_and_a_missing_file_are_refused(comm, case_file, tmp_path, capsys):
    broken = case_file.with_name("broken.toml")
    if comm.rank == 0:
        broken.write_text(CASE.replace("mould/base", "mould/bottom"))
    comm.Barrier()
    assert execute(["check", str(broken)], comm) == 2
    assert "bottom" in said(comm, capsys)
    assert execute(["check", "/nowhere/case.toml"], comm) == 2
    assert "/nowhere/case.toml" in said(comm, capsys)


def test_an_output_that_cannot_be_written_is_refused(comm, case_file, capsys):
    assert execute(["run", str(case_file), "--output", str(case_file)], comm) == 2
    assert "is a file" in said(comm, capsys)


def test_wrong_arguments_are_refused(comm, capsys):
    assert execute(["solve"], comm) == 2
    assert "No such command 'solve'" in said(comm, capsys)
    assert execute(["run"], comm) == 2


@pytest.mark.parametrize(
    "error, code", [(ConvergenceError("no step"), 3), (KeyboardInterrupt(), 130)]
)
def test_exit_codes_of_the_other_endings(comm, monkeypatch, capsys, error, code):
    def fail(*arguments, **options):
        raise error

    monkeypatch.setattr(castx.command.run, "run", fail)
    assert execute(["run", "case.toml"], comm) == code
    assert "Traceback" not in said(comm, capsys)


def test_a_run_that_does_not_converge_leaves_its_last_state(
    comm, case_file, shared_tmp_path, capsys
):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder)]
    for override in ("solver.mechanics.snes_max_it=0", "time.smallest_step=0.05"):
        arguments += ["--set", override]
    assert execute(arguments, comm) == 3
    assert "castx: not converged: no solution with the smallest step" in said(comm, capsys)
    assert json.loads((folder / "run.json").read_text())["exit"]["reason"] == "not converged"
    assert "casting_00000_0.vtu" in (folder / "fields" / "castx.pvd").read_text()


@pytest.mark.serial
def test_a_bug_shows_its_traceback(comm, monkeypatch, capsys):
    def fail(*arguments, **options):
        raise ZeroDivisionError("oh")

    monkeypatch.setattr(castx.command.run, "run", fail)
    assert execute(["run", "case.toml"], comm) == 1
    assert "ZeroDivisionError: oh" in capsys.readouterr().err


def test_check_names_what_the_mesh_has_and_warns(comm, case_file, capsys):
    assert execute(["check", str(case_file)], comm) == 0
    text = said(comm, capsys)
    for name in ("casting/top", "mould/outside", "displacement normal", "9 pairs", "condensed"):
        assert name in text
    assert "warning: steel-H13 (mould) has data for less than the temperatures of the case" in text
    assert "young_modulus, poisson_ratio, expansion (20 to 600 °C)" in text


def test_check_looks_at_patches_and_temperature_fields(comm, case_file, capsys):
    radiation = "interfaces.0.heat.radiation={ emissivities = [0.3, 0.8] }"
    patch = "interfaces.0.heat.patches=[{ within = { z = [%s, 1] }, closed = 500 }]"
    given = ["check", str(case_file), "--set", radiation, "--set", patch % 0.01]
    assert execute(given, comm) == 0
    assert "limited and radiation, other on 1 of its parts" in said(comm, capsys)
    assert execute(["check", str(case_file), "--set", patch % 0.9], comm) == 2
    field = 'bodies.0.temperature={ file = "lost.vtu", field = "T" }'
    assert execute(["check", str(case_file), "--set", field], comm) == 2
    text = said(comm, capsys)
    assert "heat.patches[0] holds no node" in text
    assert "initial temperature of 'casting': there is no file" in text


def test_mesh_writes_a_gmsh_file(comm, case_file, shared_tmp_path, capsys):
    target = shared_tmp_path / "part.msh"
    assert execute(["mesh", str(case_file), "-o", str(target)], comm) == 0
    assert b'"outside"' in target.read_bytes()
    assert execute(["mesh", str(case_file), "-o", "/nowhere/part.msh"], comm) == 2
    assert "cannot write /nowhere/part.msh" in said(comm, capsys)


def test_materials_are_listed_with_those_of_a_case(comm, case_file, capsys):
    assert execute(["materials"], comm) == 0
    text = said(comm, capsys)
    assert "AlSi7Mg" in text and "548 to 645" in text and "data: h heat" in text
    own = case_file.with_name("own.toml")
    if comm.rank == 0:
        own.write_text(CASE + '[materials.chill]\nextends = "Cu-pure"\nstress_free = 20\n')
    comm.Barrier()
    assert execute(["materials", "--case", str(own)], comm) == 0
    assert "of the case, extends" in said(comm, capsys)
    assert execute(["materials", "chill", "--case", str(own)], comm) == 0
    text = said(comm, capsys)
    assert "chill: of the case, extends Cu-pure" in text and "case file" in text
    assert execute(["materials", "chill"], comm) == 2
    assert "unknown material 'chill'" in said(comm, capsys)


def test_numbers_and_curves_of_a_material(comm, shared_tmp_path, capsys):
    assert execute(["materials", "Al-pure"], comm) == 0
    text = said(comm, capsys)
    assert "latent_heat" in text and "397 kJ/kg" in text and "case file" not in text
    assert "castx materials Al-pure --plot Al-pure.png" in text
    assert execute(["materials", "Al-pur"], comm) == 2
    assert '"Al-pure"?' in said(comm, capsys)
    picture = shared_tmp_path / "aluminium.png"
    assert execute(["materials", "Al-pure", "--plot", str(picture)], comm) == 0
    assert f"written: {picture}" in said(comm, capsys)
    assert picture.read_bytes().startswith(b"\x89PNG")
    for arguments, text in (
        (["materials", "Al-pure", "--plot", str(picture.with_suffix(".bmp"))], "must end in .png"),
        (["materials", "Al-pure", "--plot", "/nowhere/a.png"], "cannot write /nowhere/a.png"),
        (["materials", "--plot", str(picture)], "castx materials NAME --plot FILE"),
    ):
        assert execute(arguments, comm) == 2
        assert text in said(comm, capsys)


def test_a_run_names_a_material_that_leaves_its_range_once(comm, case_file, tmp_path, capsys):
    arguments = ["run", str(case_file), "--set", "bodies.1.temperature=620"]
    folder = comm.bcast(str(tmp_path / "hot"))
    assert execute([*arguments, "--output", folder], comm) == 0
    text = " ".join(said(comm, capsys).split())
    assert text.count("said once for each material") == 1
    assert "at t = 0 s steel-H13 (mould) is at 620 to 620 °C" in text


def test_info(comm, capsys):
    assert execute(["info"], comm) == 0
    assert "fenics-dolfinx" in said(comm, capsys)


def start(*arguments: str) -> subprocess.Popen[str]:
    """Start castx in a process of its own, which must not take itself for a rank of this run."""
    foreign = ("PMIX", "OMPI_", "PRTE", "PMI_")
    kept = {key: value for key, value in os.environ.items() if not key.startswith(foreign)}
    kept |= {key: value for key, value in os.environ.items() if "_MCA_" in key or "ALLOW" in key}
    return subprocess.Popen(
        arguments, env=kept, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.mark.serial
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_a_run_after_its_step_with_its_files(comm, case_file, tmp_path, number):
    folder = tmp_path / "out"
    process = start(
        sys.executable, "-m", "castx", "run", str(case_file), "--output", str(folder),
        "--set", "time.end=1e4", "--set", "time.largest_step=0.01",
        "--set", "time.first_step=0.01",
    )  # fmt: skip
    wait_for(lambda: (folder / "history.csv").exists() and steps(folder) > 3, process)
    process.send_signal(number)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    record = json.loads((folder / "run.json").read_text())
    assert record["exit"] == {"reason": "interrupted", "message": "stopped by a signal"}
    assert record["totals"]["steps"] == steps(folder) - 1
    assert (folder / "fields" / "castx.pvd").read_text().count("casting_00001_0.vtu") == 1


def steps(folder: Path) -> int:
    return len((folder / "history.csv").read_text().splitlines()) - 1


def wait_for(condition, process, seconds=120.0):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end or process.poll() is not None:
            process.kill()
            raise AssertionError(process.communicate())
        time.sleep(0.1)


@pytest.mark.serial
def test_a_bug_on_one_rank_ends_all_of_them(tmp_path):
    script = tmp_path / "one.py"
    script.write_text(
        "import sys\n"
        "from mpi4py import MPI\n"
        "import castx.command.run\n"
        "from castx.command.cli import execute\n"
        "def fail(*arguments, comm, **options):\n"
        "    if comm.rank == 1:\n"
        "        raise ZeroDivisionError('on one rank')\n"
        "    comm.Barrier()\n"
        "castx.command.run.run = fail\n"
        "sys.exit(execute(['run', 'case.toml'], MPI.COMM_WORLD))\n"
    )
    process = start("mpirun", "-n", "2", sys.executable, str(script))
    _, errors = process.communicate(timeout=60)
    assert process.returncode != 0
    assert "ZeroDivisionError: on one rank" in errors
