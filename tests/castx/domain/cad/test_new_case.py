"""What a first case file says of a CAD part is what the part is."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.case.cad.template import case_text
from castx.domain.cad.guarded import meshed_apart
from castx.domain.cad.new_case import new_case, write_new_case
from castx.errors import CaseError
from tests.cad_files import two_blocks, write_cad

pytestmark = pytest.mark.serial


def test_an_assembly_keeps_its_bodies(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    (tmp_path / "cases").mkdir()
    case = new_case(path, tmp_path / "cases" / "a.toml")
    assert (case.file, case.margin) == ("../two.step", None)
    assert case.size == pytest.approx(0.0025)  # a twelfth of 30 mm
    assert dict(case.bodies) == pytest.approx({"casting": 4e-6, "die": 6e-6})
    assert case.interfaces == (("casting", "die", pytest.approx(4e-4)),)
    assert dict(case.surfaces) == pytest.approx({"casting/outside": 12e-4, "die/outside": 18e-4})


def test_a_lone_solid_gets_a_mould(tmp_path):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 40, 10, 10)])
    case = new_case(path, tmp_path / "bar.toml")
    assert case.margin == pytest.approx(0.01)
    block = 0.06 * 0.03 * 0.03
    assert dict(case.bodies) == pytest.approx({"bar": 4e-6, "mould": block - 4e-6})
    assert case.interfaces == (("bar", "mould", pytest.approx(18e-4)),)


def test_walls_too_thin_for_a_cell_are_taken_as_they_come(tmp_path, monkeypatch):
    def few_cells(part, mesh):
        return meshed_apart(replace(part, most_cells=3e3), mesh)

    def thin(occ):
        block, pocket = occ.addBox(0, 0, 0, 120, 40, 10), occ.addBox(0.6, 15, 4, 9, 10, 6)
        ((_, part),), _ = occ.cut([(3, block)], [(3, pocket)], removeTool=False)
        return [part, pocket]

    path = write_cad(tmp_path / "thin.step", thin, ["part", "pin"])
    assert "\nacross = 1 " in case_text(new_case(path, tmp_path / "a.toml"))
    monkeypatch.setattr("castx.domain.cad.new_case.meshed_apart", few_cells)
    assert "\nacross = 0 " in case_text(new_case(path, tmp_path / "a.toml"))


def test_refused(tmp_path):
    with pytest.raises(CaseError, match=r"part.msh: a CAD file is needed: \.step"):
        write_new_case(tmp_path / "part.msh", tmp_path / "a.toml")
    (tmp_path / "a.toml").write_text("")
    with pytest.raises(CaseError, match=r"a\.toml exists; give another one with --output"):
        write_new_case(tmp_path / "part.step", tmp_path / "a.toml")
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 9, 9, 9)])
    with pytest.raises(CaseError, match=r"cannot write .*nowhere/a\.toml: No such file"):
        write_new_case(path, tmp_path / "nowhere" / "a.toml")
