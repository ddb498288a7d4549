"""Narrow faces are taken out with what they bound, stay where nothing closes, or are refused."""

from __future__ import annotations

from math import pi

import gmsh
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.description import CadPart
from castx.meshes.cad.healing import details
from castx.meshes.cad.narrow import refuse_narrow_faces, without_narrow_faces
from castx.meshes.cad.reading import Solid

pytestmark = pytest.mark.serial


def grooved(occ, width=0.2):
    """A cylinder of radius 10 and height 20 with a groove 0.5 deep."""
    body, whole, core = (occ.addCylinder(0, 0, z, 0, 0, h, r)
                         for z, h, r in ((0, 20, 10), (9, width, 11), (9, width, 9.5)))  # fmt: skip
    ring, _ = occ.cut([(3, whole)], [(3, core)])
    ((_, tag),), _ = occ.cut([(3, body)], ring)
    occ.synchronize()
    return tag


def test_a_groove_goes_and_its_volume_comes():
    with gmsh_session():
        solids = [Solid(grooved(gmsh.model.occ), "shaft", "")]
        kept, remarks = without_narrow_faces(solids, 0.6e-3)
        assert gmsh.model.occ.getMass(3, kept[0].tag) == pytest.approx(2000.0 * pi, rel=1e-9)
        assert len(details([kept[0].tag])) == 3 + 3  # two ends, one side, and their edges
        lost = 0.2 * (10.0**2 - 9.5**2) / (20.0 * 10.0**2 - 0.2 * (10.0**2 - 9.5**2))
        assert remarks == [
            "shaft: 3 faces narrower than geometry.narrowest, 0.0006 m, are left out with the "
            "grooves, threads or roundings that they bound, which changes its volume by "
            f"{100 * lost:+.2g} %: {remarks[0].rpartition(': ')[2]}"
        ]
        assert "0.0002 m wide" in remarks[0]


def test_wider_faces_stay_and_so_does_all_without_the_key():
    with gmsh_session():
        tag = grooved(gmsh.model.occ)
        for narrowest in (0.0, 1e-4):
            assert without_narrow_faces([Solid(tag, "a", "")], narrowest) == (
                [Solid(tag, "a", "")],
                [],
            )


def test_the_rim_of_a_plate_stays():
    with gmsh_session():
        tag = gmsh.model.occ.addBox(0, 0, 0, 40, 30, 1)
        gmsh.model.occ.synchronize()
        kept, remarks = without_narrow_faces([Solid(tag, "plate", "")], 2e-3)
        assert gmsh.model.occ.getMass(3, kept[0].tag) == pytest.approx(1200.0)
        assert remarks[0].startswith("plate: 0 faces narrower")
        assert remarks[0].endswith("; 4 others are narrower and stay, nothing closes there")


def test_a_crowd_of_narrow_faces_is_refused_with_the_width_that_takes_them_out():
    with gmsh_session():
        solid = Solid(grooved(gmsh.model.occ), "shaft", "")
        part = CadPart((), 0.005, most_cells=500.0)
        text = r"about 1\.5e\+03 cells, .* allows 5\.0e\+02, on 3 narrow faces .* is 0\.0002 m wide"
        with pytest.raises(ValueError, match=text) as told:
            refuse_narrow_faces(part, [solid.tag])
        width = float(str(told.value).partition("narrowest = ")[2].partition(",")[0])
        assert width == pytest.approx(1.1 * 5e-4)
        refuse_narrow_faces(CadPart((), 0.005, most_cells=2e3), [solid.tag])
        refuse_narrow_faces(CadPart((), 1.5e-3, most_cells=500.0), [solid.tag])  # cells as small
        kept, _ = without_narrow_faces([solid], width)
        refuse_narrow_faces(part, [kept[0].tag])
