"""From a CAD file to the file of a mesh, in one go."""

from __future__ import annotations

import gmsh
import pytest

from castx.domain.gmsh_import import read_model
from castx.domain.source import gmsh_session
from castx.meshes.cad.description import CadFile, CadPart, Selector
from castx.meshes.cad.part import mesh_part
from tests.cad_files import bush_in_ring, write_cad

pytestmark = pytest.mark.serial

NAMES = ("bush", "ring")


def test_a_fine_mesh_of_a_round_part_meets_cad_to_a_thousandth(tmp_path):
    path = write_cad(tmp_path / "bush.step", lambda occ: bush_in_ring(occ, 2), NAMES)
    part = CadPart(
        (CadFile(str(path)),), 0.01, NAMES, curvature=100.0,
        selectors=(Selector("mantle", radius=0.02),),
    )  # fmt: skip
    with gmsh_session():
        report = mesh_part(part, str(tmp_path / "bush.msh"))
    for measure in (*report.bodies, *report.surfaces, *report.interfaces):
        assert measure.mesh == pytest.approx(measure.cad, rel=1e-3)
    assert "ring/mantle" in [measure.name for measure in report.surfaces]
    with gmsh_session():
        gmsh.merge(str(tmp_path / "bush.msh"))
        mesh = read_model(NAMES, 3, "bush")
    assert mesh.surface_names == ("mantle", "outside")
    assert mesh.points[:, 2].max() == 0.002


def test_other_bodies_than_those_of_the_case_are_refused(tmp_path):
    path = write_cad(tmp_path / "bush.step", bush_in_ring, NAMES)
    with gmsh_session(), pytest.raises(ValueError, match="no solid is the body 'casting'"):
        mesh_part(
            CadPart((CadFile(str(path)),), 0.01, ("bush", "casting")), str(tmp_path / "a.msh")
        )
