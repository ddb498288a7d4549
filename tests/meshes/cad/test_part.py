"""From a CAD file to the file of a mesh, in one go."""

from __future__ import annotations

import gmsh
import pytest

from castx.domain.gmsh_import import read_model
from castx.domain.source import gmsh_session
from castx.meshes.cad import part as part_module
from castx.meshes.cad.cells import Quality
from castx.meshes.cad.description import CadFile, CadPart, Selector
from castx.meshes.cad.part import mesh_part, nearly_flat, unusual_size
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


@pytest.mark.parametrize(("side", "told"), [(2, False), (0.5, True), (9e3, False), (3e4, True)])
def test_a_part_in_a_mistaken_unit_is_told(tmp_path, side, told):
    """Sides in millimetres; 30 m are a part of 30 mm whose millimetres were taken for metres."""
    path = write_cad(tmp_path / "a.step", lambda occ: [occ.addBox(0, 0, 0, side, side, side)])
    with gmsh_session():
        part = CadPart((CadFile(str(path)),), side * 1e-3, ("a",), across=0)
        remarks = mesh_part(part, str(tmp_path / "a.msh")).remarks
    assert remarks == tuple(unusual_size(side * 1e-3))
    assert bool(remarks) == told
    if told:
        assert f"is {side * 1e-3:g} m" in remarks[0] and "in the right unit" in remarks[0]


def test_flat_cells_are_told_below_a_hundredth():
    for worst, told in ((0.0024, 1), (0.011, 0)):
        quality = Quality(9, 0.7, worst, (0.01222, -0.0001927, 0.0379), 5, 4e-6, 0.0122)
        found = list(nearly_flat(quality))
        assert len(found) == told
        assert not told or found[0].startswith(
            "the worst cell, at (0.01222, -0.0001927, 0.0379) m, has a quality of 0.0024, and below"
        )


def test_a_mesh_with_flat_cells_has_a_remark_with_the_cure(tmp_path, monkeypatch):
    monkeypatch.setattr(part_module, "SLOW_CELL", 1.0)
    path = write_cad(tmp_path / "a.step", lambda occ: [occ.addBox(0, 0, 0, 20, 20, 10)])
    with gmsh_session():
        (told,) = mesh_part(CadPart((CadFile(str(path)),), 0.01), str(tmp_path / "a.msh")).remarks
    assert "geometry.narrowest above the width of their faces" in told
