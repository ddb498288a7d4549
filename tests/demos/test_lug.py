"""The part of the tutorial, and that the tutorial says what castx writes and reads."""

from __future__ import annotations

import re
from math import pi
from pathlib import Path

import gmsh
import pytest

from castx.case.cad.template import case_text
from castx.case.reading.read import load_case
from castx.domain.cad.new_case import new_case
from castx.domain.source import named_mesh
from demos.parts import lug
from demos.parts.assembly import volumes, write_step
from demos.parts.solids import drawing

pytestmark = pytest.mark.serial

PAGE = Path(__file__).parents[2] / "docs" / "manual" / "cad_tutorial.md"
CASE = Path(lug.__file__).with_suffix(".toml")


def blocks(kind):
    return re.findall(rf"```{kind}\n(.*?)```", PAGE.read_text(), re.S)


@pytest.fixture(scope="module")
def step(tmp_path_factory):
    path = tmp_path_factory.mktemp("lug") / "lug.step"
    with drawing("lug"):
        assembly = lug.lug(lug.Lug())
        assert volumes(assembly)["lug"] == pytest.approx(volume(lug.Lug()), rel=1e-9)
        write_step(assembly, path)
        assert len(gmsh.model.getEntities(3)) == 1
    return path


def volume(p):
    """Return the plate with two rounded corners and a bore, and the boss above it."""
    corners = (1.0 - pi / 4.0) * p.fillet**2 * 2
    plate = (p.length * p.width - corners - pi * p.bore**2) * p.thickness
    return plate + pi * p.boss**2 * (p.height - p.thickness)


def test_the_case_of_the_tutorial_is_the_one_castx_writes_with_what_it_adds(step):
    written, whole = case_text(new_case(step, step.with_suffix(".toml"))), CASE.read_text()
    for block in blocks("toml"):
        for part in filter(None, block.split("\n\n")):
            assert all(line in whole for line in part.splitlines()), part
    said = "".join(blocks("toml"))
    for line in whole.splitlines():
        assert line in written or line in said, line
    assert "mould = {" in written and "# surfaces" in written


def test_the_surfaces_of_the_tutorial_are_found(step):
    (step.parent / "own.toml").write_text(CASE.read_text())
    case = load_case(step.parent / "own.toml")
    report = named_mesh(case.geometry, [body.name for body in case.bodies]).report
    found = {measure.name: measure.cad for measure in report.surfaces}
    assert set(found) == {"lug/top", "mould/cooling", "mould/outside"}
    assert found["lug/top"] == pytest.approx(pi * 0.01**2, rel=1e-9)
    assert found["mould/cooling"] == pytest.approx(pi * 0.006 * 0.06, rel=1e-9)
    assert {probe.below for probe in case.probes} == {None, "lug/mould"}
