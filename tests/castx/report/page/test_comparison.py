"""Several runs beside each other: their numbers, their curves, and what is refused."""

from __future__ import annotations

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from castx.errors import CaseError
from castx.report.page import comparison
from castx.report.page.charts import Panel, Section
from castx.report.page.comparison import (
    ComparedRun,
    cell,
    refuse_strangers,
    write_comparison,
    write_page,
)
from castx.report.summary.finding import Finding
from tests.castx.report.page.test_report import Page

pytestmark = pytest.mark.serial

TIME = np.array([0.0, 1.0, 2.0])
HOSTILE = "<i>B</i>"


def compared(label, *found, curve="centre", factor=1.0):
    record = {
        "exit": {"reason": "finished"}, "started": "today", "time_reached": 2.0, "end": 2.0,
        "totals": {"steps": 2, "cutbacks": 0, "heat_iterations": 3, "mechanics_iterations": 4,
                   "passes": 5}, "peak_memory": {}, "wall": 1.0, "ranks": 1,
    }  # fmt: skip
    run = SimpleNamespace(
        record=record, case={"name": "a case"}, model="3d", bodies=("casting",), history={},
        probes={"time": TIME, f"{curve}.temperature": TIME}, doubts=(),
    )  # fmt: skip
    lines = {curve: factor * TIME}
    sections = [Section("Cooling curves", "", TIME, [Panel("T [°C]", lines)])]
    return ComparedRun(label, run, {finding.name: finding for finding in found}, sections)


def gap(value):
    return Finding("Largest gap", "a/b", value, "µm", "", factor=1e6, time=2.0)


def test_a_number_stands_beside_that_of_the_first_run():
    first, second = compared("A", gap(1e-4)), compared("B", gap(1.1e-4))
    assert cell(first, "Largest gap: a/b", first) == ("100 µm", "", "t = 2 s")
    assert cell(second, "Largest gap: a/b", first) == ("110 µm", "+10 %", "t = 2 s")
    assert cell(compared("C"), "Largest gap: a/b", first) == ("–", "", "")
    assert cell(second, "Largest gap: a/b", compared("A", gap(0.0)))[1] == ""


def test_the_page_has_all_numbers_and_curves(tmp_path, monkeypatch):
    runs = [compared("A", gap(1e-4)), compared(HOSTILE, gap(2e-4), factor=3.0)]
    monkeypatch.setattr(comparison, "compared", lambda folders: runs)
    target = write_comparison([tmp_path / "A", tmp_path / "B"], tmp_path / "c.html")
    text = target.read_text()
    page = Page(text)
    assert not page.open and "http:" not in text and HOSTILE not in text
    assert "".join(page.texts["h1"]) == f"A beside {HOSTILE}"
    assert page.texts["Largest gap: a/b"] == ["100 µm", "200 µm"]
    (section,) = page.data("curves")
    names = [line["name"] for table in section["panels"][0]["tables"] for line in table["lines"]]
    assert names == ["centre, A", f"centre, {HOSTILE}"]
    assert section["panels"][0]["tables"][1]["lines"][0]["values"] == [0.0, 3.0, 6.0]
    assert "2, 0 of them cut" in page.texts["td"]
    assert write_comparison([tmp_path / "A", tmp_path / "B"], target) == target


def test_runs_that_share_nothing_are_refused():
    alone = compared("C", curve="wall")
    told = r"C shares neither .* C has bodies casting and probes wall"
    with pytest.raises(CaseError, match=told):
        refuse_strangers([compared("A", gap(1e-4)), compared("B", gap(1e-4)), alone])
    refuse_strangers([compared("A", gap(1e-4)), compared("B", gap(1e-4), curve="wall")])
    refuse_strangers([compared("A"), compared("B")])


def test_a_file_of_somebody_else_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(comparison, "compared", lambda folders: [compared("A"), compared("B")])
    other = tmp_path / "notes.html"
    other.write_text("<html>notes</html>")
    with pytest.raises(CaseError, match="not a page of castx"):
        write_comparison([], other)
    assert other.read_text() == "<html>notes</html>"
    with pytest.raises(CaseError, match="is a folder"):
        write_comparison([], tmp_path)


def test_a_folder_named_twice_is_refused(tmp_path):
    with pytest.raises(CaseError, match="named twice"):
        write_comparison([tmp_path, tmp_path / "." / ""], tmp_path / "c.html")


def test_one_run_has_its_report_and_several_their_comparison(tmp_path, monkeypatch):
    monkeypatch.setattr(comparison, "write_report", lambda folder: folder / "report.html")
    monkeypatch.setattr(comparison, "write_comparison", lambda folders, target: target)
    first, second = tmp_path / "a", tmp_path / "b"
    assert write_page([first], None) == first / "report.html"
    assert write_page([first, second], None).name == "comparison.html"
    assert write_page([first, second], tmp_path / "c.html") == tmp_path / "c.html"
    with pytest.raises(CaseError, match="leave --output out"):
        write_page([first], tmp_path / "c.html")


def test_pages_load_no_solvers():
    code = "import sys, castx.report.page.comparison; print(list(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"dolfinx", "gmsh", "petsc4py.PETSc", "ufl"} & set(eval(found.stdout))
