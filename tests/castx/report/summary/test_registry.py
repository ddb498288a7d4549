"""All findings of a run."""

import subprocess
import sys

import pytest

from castx.report.summary.registry import FINDERS, findings, leading
from tests.castx.report.summary.fake_run import run
from tests.castx.report.summary.test_solid import end

pytestmark = pytest.mark.serial


def test_findings_come_in_the_order_of_the_registry_and_have_names_of_their_own():
    found = run(model="generalised-plane-strain")
    found.record["stage_ends"] = [end(0, 3.0, 5e7, "casting", "mould")]
    every = findings(found)
    topics = [finding.topic for finding in every]
    assert topics == [
        "Freezes last", "Least Niyama", "Largest gap", "Residual stress", "Stress at the end",
        "Distortion", "Distortion",
    ]  # fmt: skip
    assert len({finding.name for finding in every}) == len(every)
    assert [finding.of for finding in leading(every)] == [
        "casting", "casting", "casting/mould", "casting", "mould", "casting",
    ]  # fmt: skip


def test_a_run_without_anything_has_no_findings():
    quiet = run(freezing=[], interfaces=())
    assert len(FINDERS) > 5 and not findings(quiet)


def test_findings_load_no_solvers():
    """So a report of a small run begins at once."""
    code = "import sys, castx.report.summary.registry; print(list(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"dolfinx", "gmsh", "petsc4py.PETSc", "ufl"} & set(eval(found.stdout))
