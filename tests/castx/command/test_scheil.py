"""The command that writes Scheil curves: what it refuses, and that it writes with the packages."""

from __future__ import annotations

import tomllib
from importlib.util import find_spec

from mpi4py import MPI

import pytest

from castx.command.cli import Exit, execute
from tests.castx.materials.test_scheil import DATABASE

pytestmark = pytest.mark.serial
HAVE = all(find_spec(name) for name in ("pycalphad", "scheil"))


def test_words_that_are_no_alloy_are_refused(capfd):
    assert execute(["scheil", "some.tdb", "AL", "SI"], MPI.COMM_SELF) == Exit.REFUSED
    assert "SI=7" in capfd.readouterr().err


@pytest.mark.skipif(not HAVE, reason="pycalphad and scheil are not installed")
def test_a_file_with_the_table_is_written(tmp_path):
    database, file = tmp_path / "ideal.tdb", tmp_path / "alloy.toml"
    database.write_text(DATABASE)
    words = ["scheil", str(database), "AA", "BB=2", "--rest", "0.2", "--step", "4"]
    assert execute([*words, "-o", str(file)], MPI.COMM_SELF) == Exit.DONE
    rows = tomllib.loads(file.read_text())["materials"]["alloy"]["solid_fraction"]
    assert rows[-1][1] == 0.0 and 0.75 < rows[0][1] < 1.0


@pytest.mark.skipif(HAVE, reason="pycalphad and scheil are installed")
def test_missing_packages_are_named_with_what_installs_them(capfd):
    assert execute(["scheil", "some.tdb", "AL", "SI=7"], MPI.COMM_SELF) == Exit.REFUSED
    assert "pip install pycalphad scheil" in " ".join(capfd.readouterr().err.split())
