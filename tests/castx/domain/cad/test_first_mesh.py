"""First meshes are tried until one is made; where all are refused, it is said what helps."""

from __future__ import annotations

from dataclasses import replace

import gmsh
import pytest

from castx.case.cad.template import case_text
from castx.domain.cad import first_mesh as first_mesh_module
from castx.domain.cad.first_mesh import attempts, part_as_it_comes, survey
from castx.domain.cad.guarded import SizesError, meshed_apart
from castx.domain.cad.new_case import new_case
from castx.errors import MeshError
from castx.meshes.cad.description import CadFile, CadPart
from tests.cad_files import write_cad

pytestmark = pytest.mark.serial


def filleted(occ):
    """A block whose upper edge is rounded by a hundredth of a millimetre."""
    block = occ.addBox(0, 0, 0, 40, 20, 10)
    occ.synchronize()
    edges = gmsh.model.getEntitiesInBoundingBox(-1, -1, 9, 41, 1, 11, dim=1)
    ((_, part),) = occ.fillet([block], [edges[0][1]], [0.01])
    return [part]


def test_tiny_fillets_are_refused_at_once_with_a_cure_that_works(tmp_path, monkeypatch):
    path = write_cad(tmp_path / "crank.step", filleted)
    part = CadPart((CadFile(str(path)),), 0.004, across=0, most_cells=2e4)
    with pytest.raises(MeshError, match=r"a radius of 1e-05 m .* geometry.tolerance = 4e-05"):
        meshed_apart(part, tmp_path / "a.msh", 60.0)
    assert meshed_apart(replace(part, tolerance=4e-5), tmp_path / "a.msh", 60.0).quality.cells > 100
    monkeypatch.setattr("castx.domain.cad.first_mesh.FIRST_CELLS", 7e3)
    said = []
    case = new_case(path, tmp_path / "a.toml", say=said.append)
    assert 'tolerance = "0.1 mm"' in case_text(case) and case.across == 0
    assert said == [
        "meshing crank.step, coarsely, to see its bodies and faces",
        "that makes no first mesh; next: walls as they come",
        "that makes no first mesh; next: without faces narrower than 0.1 mm",
        "meshing it again, in its mould",
    ]


def test_what_makes_no_mesh_is_tried_without_narrow_faces_and_then_refused(tmp_path, monkeypatch):
    asked, given = [], []

    def meshed(part, _, patience):
        asked.append((part.across, part.tolerance, part.narrowest))
        given.append(patience)
        raise SizesError("the cells are flat")

    monkeypatch.setattr(first_mesh_module, "meshed_apart", meshed)
    path, said = write_cad(tmp_path / "crank.step", filleted), []
    with pytest.raises(MeshError, match=r"flat\. It is refused without .* 3 mm too.* in CAD, and"):
        new_case(path, tmp_path / "a.toml", say=said.append)
    assert asked == [(1, 1e-6, 0), (0, 1e-6, 0), (0, 1e-4, 0), (0, 1e-6, 1e-3), (0, 1e-6, 3e-3)]
    assert given == [60.0, 60.0, 60.0, 60.0, 600.0], "a part of hours is given up before"
    assert said[-1].endswith("next: without grooves, threads and roundings of less than 3 mm")


def test_a_survey_begins_where_it_is_told(tmp_path, monkeypatch):
    asked = []

    def meshed(part, *_):
        asked.append(part.narrowest)
        raise SizesError("the cells are flat")

    monkeypatch.setattr(first_mesh_module, "meshed_apart", meshed)
    with pytest.raises(MeshError):
        survey(part_as_it_comes(tmp_path / "a.step"), lambda _: None, first=3)
    assert asked == [way.changes["narrowest"] for way in attempts()[3:]] == [1e-3, 3e-3]
