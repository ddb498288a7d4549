"""The command line: what it prints, and exit codes that are the same on all ranks."""

import gc
import re
import subprocess
import sys

import pytest

import castx.command.run
from castx.command.cli import execute, main
from castx.commit import commit
from castx.errors import ConvergenceError
from tests.castx.command_line import start

PNG = b"\x89PNG"


def test_newton_iterations_are_shown_on_request(comm, case_file, shared_tmp_path, said):
    arguments = ["run", str(case_file), "--output", str(shared_tmp_path / "out"),
                 "--set", "time.end=0.05", "--set", "time.smallest_step=0.02"]  # fmt: skip
    assert execute([*arguments, "--log", "newton"], comm) == 0
    text = said()
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
    text = said()
    assert "the mechanical equilibrium: diverged max it after 0 iterations" in text
    assert "step of 0.025 s from 0 s" in text
    assert execute(arguments, comm) == 0
    assert "residuals" not in said()
    assert execute([*arguments, "--log", "everything"], comm) == 2
    assert re.search("'everything' is not .*'newton'", said())


@pytest.mark.ranks
def test_the_version_is_told_by_the_first_rank(comm, capsys):
    assert execute(["--version"], comm) == 0
    told = ["castx", castx.__version__, "(commit", f"{commit()})"] if comm.rank == 0 else []
    assert capsys.readouterr().out.split() == told


@pytest.mark.serial
def test_python_without_docstrings_is_refused_in_words(case_file):
    """Parsers below DOLFINx take their grammar from docstrings, and end in a traceback."""
    process = start(sys.executable, "-OO", "-m", "castx", "check", str(case_file))
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 2 and "PYTHONOPTIMIZE" in errors
    assert "Traceback" not in output + errors


@pytest.mark.ranks
def test_wrong_arguments_are_refused(comm, said):
    assert execute(["solve"], comm) == 2
    assert "No such command 'solve'" in said()
    assert execute(["run"], comm) == 2


@pytest.mark.parametrize(
    "error, code", [(ConvergenceError("no step"), 3), (KeyboardInterrupt(), 130)]
)
def test_exit_codes_of_the_other_endings(comm, case_file, monkeypatch, said, error, code):
    def fail(case, settings):
        raise error

    monkeypatch.setattr(castx.command.run, "run_case", fail)
    assert execute(["run", str(case_file)], comm) == code
    assert "Traceback" not in said()


@pytest.mark.serial
def test_a_bug_shows_its_traceback(comm, case_file, monkeypatch, capsys):
    def fail(case, settings):
        raise ZeroDivisionError("oh")

    monkeypatch.setattr(castx.command.run, "run_case", fail)
    assert execute(["run", str(case_file)], comm) == 1
    assert "ZeroDivisionError: oh" in capsys.readouterr().err


def test_mesh_writes_a_gmsh_file(comm, case_file, shared_tmp_path, said):
    target = shared_tmp_path / "part.msh"
    assert execute(["mesh", str(case_file), "-o", str(target)], comm) == 0
    assert b'"outside"' in target.read_bytes()
    assert execute(["mesh", str(case_file), "-o", "/nowhere/part.msh"], comm) == 2
    assert "cannot write /nowhere/part.msh" in said()


def test_mesh_writes_files_for_other_programs(comm, case_file, shared_tmp_path, said):
    target = shared_tmp_path / "part.vtu"
    assert execute(["mesh", str(case_file), "-o", str(target)], comm) == 0
    assert b"<VTKFile" in target.read_bytes()[:200]
    assert execute(["mesh", str(case_file), "-o", "part.doc"], comm) == 2
    assert "cannot write part.doc: formats: " in said()


@pytest.mark.ranks
def test_export_names_what_is_missing_and_what_it_writes(comm, case_file, shared_tmp_path, said):
    folder = shared_tmp_path / "out"
    assert execute(["run", str(case_file), "--output", str(folder)], comm) == 0
    target = shared_tmp_path / "nodes.csv"
    given = ["export", str(folder), "-o", str(target), "--body", "casting"]
    assert execute([*given, "--to", "csv"], comm) == 2
    assert "run the case again with" in said()
    assert execute([*given, "--to", "word"], comm) == 2


@pytest.mark.ranks
def test_check_draws_what_it_has_found(comm, case_file, shared_tmp_path, said):
    picture = shared_tmp_path / "case.png"
    assert execute(["check", str(case_file), "--picture", str(picture)], comm) == 0
    assert picture.read_bytes().startswith(PNG)
    assert "written: " in said()
    assert execute(["check", str(case_file), "--picture", "case.doc"], comm) == 2
    assert "case.doc: the name must end in .png, .svg, .pdf" in " ".join(said().split())


@pytest.mark.ranks
def test_materials_are_listed_with_those_of_a_case(comm, case_file, said):
    assert execute(["materials"], comm) == 0
    text = said()
    assert "AlSi7Mg" in text and "548 to 645" in text and "data: h heat" in text
    own = case_file.with_name("own.toml")
    if comm.rank == 0:
        chill = '[materials.chill]\nextends = "Cu-pure"\nstress_free = 20\n'
        own.write_text(case_file.read_text() + chill)
    comm.Barrier()
    assert execute(["materials", "--case", str(own)], comm) == 0
    assert "of the case, extends" in said()
    assert execute(["materials", "chill", "--case", str(own)], comm) == 0
    text = said()
    assert "chill: of the case, extends Cu-pure" in text and "case file" in text
    assert execute(["materials", "chill"], comm) == 2
    assert "unknown material 'chill'" in said()


@pytest.mark.ranks
def test_numbers_and_curves_of_a_material(comm, shared_tmp_path, said):
    assert execute(["materials", "Al-pure"], comm) == 0
    text = said()
    assert "latent_heat" in text and "397 kJ/kg" in text and "case file" not in text
    assert "castx materials Al-pure --plot Al-pure.png" in text
    assert execute(["materials", "Al-pur"], comm) == 2
    assert '"Al-pure"?' in said()
    picture = shared_tmp_path / "aluminium.png"
    assert execute(["materials", "Al-pure", "--plot", str(picture)], comm) == 0
    assert f"written: {picture}" in said()
    assert picture.read_bytes().startswith(b"\x89PNG")
    for arguments, text in (
        (["materials", "Al-pure", "--plot", str(picture.with_suffix(".bmp"))], "must end in .png"),
        (["materials", "Al-pure", "--plot", "/nowhere/a.png"], "cannot write /nowhere/a.png"),
        (["materials", "--plot", str(picture)], "castx materials NAME --plot FILE"),
    ):
        assert execute(arguments, comm) == 2
        assert text in said()


@pytest.mark.ranks
def test_interfaces_are_listed_shown_and_drawn(comm, shared_tmp_path, said):
    assert execute(["interfaces"], comm) == 0
    text = said()
    assert "aluminium-steel-coated" in text and "castx interfaces NAME" in text
    assert execute(["interfaces", "steel-sand"], comm) == 0
    text = said()
    assert "300 to 2000" in text and "castx interfaces steel-sand --plot steel-sand.png" in text
    picture = shared_tmp_path / "steel.png"
    assert execute(["interfaces", "steel-sand", "--plot", str(picture)], comm) == 0
    assert f"written: {picture}" in said() and picture.read_bytes().startswith(PNG)
    for arguments, text in (
        (["interfaces", "steel-snad"], '"steel-sand"?'),
        (["interfaces", "--plot", str(picture)], "castx interfaces NAME --plot FILE"),
        (["interfaces", "steel-sand", "--plot", "a.bmp"], "must end in .png"),
    ):
        assert execute(arguments, comm) == 2
        assert text in said()


def test_info(comm, said):
    assert execute(["info"], comm) == 0
    assert "fenics-dolfinx" in said()


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("failure", ["ZeroDivisionError('on one rank')", "SystemExit('no file')"])
def test_a_bug_on_one_rank_ends_all_of_them(tmp_path, failure):
    """So does a library that wants to end the process."""
    script = tmp_path / "one.py"
    script.write_text(
        "import sys\n"
        "from mpi4py import MPI\n"
        "import castx.command.run\n"
        "from castx.command.cli import execute\n"
        "def fail(*arguments):\n"
        "    if MPI.COMM_WORLD.rank == 1:\n"
        f"        raise {failure}\n"
        "    MPI.COMM_WORLD.Barrier()\n"
        "castx.command.run.asked_case = fail\n"
        "sys.exit(execute(['run', 'case.toml'], MPI.COMM_WORLD))\n"
    )
    process = start("mpirun", "-n", "2", sys.executable, str(script))
    _, errors = process.communicate(timeout=60)
    assert process.returncode != 0
    assert failure.partition("(")[0] in errors


@pytest.mark.serial
def test_a_library_that_wants_to_exit_has_failed(comm, monkeypatch, capsys):
    monkeypatch.setattr("castx.command.listing.version_table", lambda: sys.exit("no file"))
    assert execute(["info"], comm) == 1
    assert "SystemExit: no file" in capsys.readouterr().err


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize(
    "arguments",
    [
        ("info",),
        ("materials",),
        ("materials", "Al-pure"),
        ("interfaces",),
        ("check", "case.toml"),
    ],
)
def test_output_that_cannot_be_written_is_one_line(case_file, arguments):
    command = [sys.executable, "-m", "castx", *arguments]
    with open("/dev/full", "w") as full:
        ended = subprocess.run(
            command, cwd=case_file.parent, stdout=full, stderr=subprocess.PIPE, text=True,
            timeout=60, check=False,
        )  # fmt: skip
    lines = [line for line in ended.stderr.splitlines() if "INFO" not in line]
    assert ended.returncode == 1
    assert lines == ["castx: the output cannot be written: No space left on device"]


@pytest.mark.serial
def test_the_command_itself_loads_neither_units_nor_solvers():
    """So --help and a mistyped command answer at once."""
    code = "import sys, castx.command.cli; print([m for m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"pint", "pydantic", "numpy", "dolfinx"} & set(eval(found.stdout))


@pytest.mark.serial
def test_a_run_loads_nothing_that_draws_and_no_optimiser():
    code = "import sys, castx.command.cli, castx.command.run; print([m for m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    unwanted = {"pint", "pyvista", "matplotlib", "scipy.optimize", "vtkmodules", "http.client"}
    assert not unwanted & set(eval(found.stdout))


@pytest.mark.serial
def test_the_end_of_the_command_searches_for_no_garbage(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["castx", "--version"])
    before = gc.get_freeze_count()
    try:
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 0 and capsys.readouterr().out.startswith("castx ")
        assert gc.get_freeze_count() > before + 1000
    finally:
        gc.unfreeze()


@pytest.mark.ranks
def test_several_results_folders_are_compared(comm, shared_tmp_path, said, monkeypatch):
    asked = []

    def write(folders, target):
        asked.append((folders, target))
        return target or "here.html"

    monkeypatch.setattr("castx.report.page.comparison.write_page", write)
    first, second = str(shared_tmp_path / "a"), str(shared_tmp_path / "b")
    assert execute(["report", first, second, "--output", "c.html"], comm) == 0
    assert "written: c.html" in said()
    assert execute(["report", first], comm) == 0
    assert "written: here.html" in said()
    assert [len(folders) for folders, _ in asked] == ([2, 1] if comm.rank == 0 else [])
