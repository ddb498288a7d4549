"""A folder full of settings that a library would obey, or execute, where it is started."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from castx.start_folder import elsewhere
from tests.castx.command_line import CASE

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[2]
ASK = """
import json, castx
from mpi4py import MPI
from petsc4py import PETSc
import dolfinx, ffcx, matplotlib
print(json.dumps([
    PETSc.Options().getAll(), str(dolfinx.jit.get_options()["cache_dir"]),
    dolfinx.jit.get_options()["cffi_extra_compile_args"], ffcx.get_options()["epsilon"],
    matplotlib.rcParams["savefig.dpi"], PETSc.__file__,
]))
"""


@pytest.fixture
def hostile(tmp_path):
    """Return a folder with every file that a library looks for where it is started."""
    compiler = {"cache_dir": "jit", "cffi_extra_compile_args": ["-fplugin=./plugin.so"]}
    (tmp_path / "machine").mkdir()
    files = {
        "dolfinx_jit_options.json": json.dumps(compiler),
        "ffcx_options.json": '{"epsilon": 0.5}',
        ".petscrc": "-log_view ascii:petsc_log\n-castx_heat_snes_max_it 0\n",
        "petscrc": "-log_view ascii:petsc_log\n",
        "petsc.cfg": f"PETSC_ARCH = {tmp_path / 'machine'}\n",
        "matplotlibrc": "backend: module://evil\nsavefig.dpi: 7\n",
        "ucx.conf": f"UCX_MODULE_DIR={tmp_path}\nUCX_LOG_FILE={tmp_path / 'ucx_log'}\n",
        "case.toml": CASE,
    }
    for name in ("evil", "numpy", "re", "json", "sysconfig"):
        files[f"{name}.py"] = "open('executed', 'w')\n"
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def started(folder: Path, *command: str) -> str:
    """Return what a command in a folder has printed."""
    found = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False, timeout=300
    )
    assert found.returncode == 0, found.stderr
    return found.stdout


def test_settings_in_the_folder_are_none(hostile):
    options, cache, compiler, epsilon, dots, petsc = json.loads(
        started(hostile, sys.executable, "-P", "-c", ASK).splitlines()[-1]
    )
    assert options == {} and Path(cache).is_absolute() and compiler == ["-O2", "-g0"]
    assert epsilon < 1e-9 and dots == "figure" and str(hostile) not in petsc


def test_a_run_leaves_nothing_but_its_results(hostile):
    before = {path.name for path in hostile.iterdir()}
    started(hostile, "castx", "run", "case.toml", "--set", "time.end=0.05")
    assert {path.name for path in hostile.iterdir()} - before == {"results"}


def test_the_launcher_runs_python_without_the_folder():
    """A file re.py there would else take the place of the module, before castx is installed."""
    for name in ("with-fenicsx", "build-wheels"):
        text = (PROJECT / "bin" / name).read_text()
        options = re.findall(r'"\$(?:python|candidate|[a-z]+/bin/python)" (-\S*)', text)
        assert options and set(options) <= {"-P", "-I"}, name


def test_the_folder_is_left_and_found_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match="inside"), elsewhere():
        assert Path.cwd() == Path("/")
        raise ValueError("inside")
    assert Path.cwd() == tmp_path
    gone = tmp_path / "gone"
    gone.mkdir()
    os.chdir(gone)
    gone.rmdir()
    with elsewhere():
        pass
    os.chdir(tmp_path)
