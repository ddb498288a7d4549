"""A mesher that refuses, dies or waits is a refused mesh, and never the end of the run."""

from __future__ import annotations

import sys

import pytest

from castx.domain.cad import guarded
from castx.domain.cad.guarded import SizesError, meshed_apart, place_in
from castx.errors import MeshError
from castx.meshes.cad.description import CadFile, CadPart
from tests.cad_files import two_blocks, write_cad

pytestmark = pytest.mark.serial


def test_a_mesh_and_its_report(tmp_path, capfd):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    capfd.readouterr()
    report = meshed_apart(CadPart((CadFile(str(path)),), 0.01), tmp_path / "mesh.msh")
    assert [body.name for body in report.bodies] == ["casting", "die"]
    assert (tmp_path / "mesh.msh").is_file()
    assert capfd.readouterr() == ("", "")  # nothing of what OpenCASCADE writes


def test_a_refusal_names_the_file(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks)
    part = CadPart((CadFile(str(path)),), 0.01, bodies=("casting",))
    with pytest.raises(MeshError, match=r"two\.step: no solid is the body 'casting'"):
        meshed_apart(part, tmp_path / "mesh.msh")


def test_a_refusal_of_the_mesh_alone_is_told_from_that_of_the_file(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks)
    part = CadPart((CadFile(str(path)),), 0.01, most_cells=2.0)
    with pytest.raises(SizesError, match=r"two\.step: about .* cells, and geometry.most_cells"):
        meshed_apart(part, tmp_path / "mesh.msh")
    with pytest.raises(MeshError) as told:
        meshed_apart(CadPart((CadFile("lost.step"),), 0.01), tmp_path / "mesh.msh")
    assert not isinstance(told.value, SizesError)


def test_a_mesher_that_dies_or_waits(tmp_path, monkeypatch):
    part = CadPart((CadFile("a.step"),), 0.01)
    script = tmp_path / "dies"
    script.write_text("#!/bin/sh\necho a word >&2\nkill -SEGV $$\n")
    script.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(script))
    with pytest.raises(MeshError, match=r"a\.step cannot be meshed: .* by SIGSEGV \(a word\)"):
        meshed_apart(part, tmp_path / "mesh.msh")
    script.write_text("#!/bin/sh\nexec sleep 20\n")
    monkeypatch.setattr(guarded, "PATIENCE", 0.2)
    with pytest.raises(SizesError, match=r"more than 0 s; choose larger sizes, .* geometry\.narr"):
        meshed_apart(part, tmp_path / "mesh.msh")


@pytest.mark.parametrize(
    ("by", "told"),
    [("SEGV", "the part is damaged"), ("KILL", "memory runs out"), ("TERM", "memory runs out")],
)
def test_a_mesher_that_the_system_stops_is_no_fault_of_the_part(tmp_path, monkeypatch, by, told):
    script = tmp_path / "ends"
    script.write_text(f"#!/bin/sh\nkill -{by} $$\n")
    script.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(script))
    with pytest.raises(MeshError, match=rf"a\.step cannot be meshed: .* by SIG{by} .*{told}"):
        meshed_apart(CadPart((CadFile("a.step"),), 0.01), tmp_path / "mesh.msh")


def test_the_place_where_faces_cross():
    said = "PLC Error:  A segment and a facet intersect at point (8.5,-1e1,0).\n"
    assert place_in(said) == " (faces cross at (0.0085, -0.01, 0) m)"
    assert place_in("nothing") == ""
