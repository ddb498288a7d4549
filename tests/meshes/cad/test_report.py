"""Volumes and areas of a mesh beside those of the part."""

from __future__ import annotations

import json
from math import pi, sin

import gmsh
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.assembly import join
from castx.meshes.cad.cells import cell_qualities, quality_of, solid_volumes
from castx.meshes.cad.description import CadFile, CadPart
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.meshing import generate
from castx.meshes.cad.reading import Solid
from castx.meshes.cad.report import Report, report_of
from castx.meshes.cad.selection import named_faces
from tests.cad_files import bush_in_ring, two_blocks

pytestmark = pytest.mark.serial


def reported(scratch, solids, size, curvature, *names):
    with gmsh_session():
        tags = solids(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        made = [Solid(tag, name, name) for tag, name in zip(tags, names, strict=True)]
        drawn = solid_volumes({solid.tag: solid.name for solid in made})
        volumes = join(made, 0.0)
        faces = faces_of(volumes)
        named = named_faces((), faces, names, "outside")
        part = CadPart((CadFile("a.step"),), size, curvature=curvature, across=1)
        generate(part, volumes, faces, named, scratch)
        quality = quality_of(*cell_qualities(list(volumes)))
        return report_of(volumes, drawn, faces, named, quality, ["mended"])


def test_planar_parts_are_met_to_round_off(tmp_path):
    report = reported(str(tmp_path / "sizes"), two_blocks, 0.01, 4.0, "casting", "die")
    for measure in (*report.bodies, *report.surfaces, *report.interfaces):
        assert measure.mesh == pytest.approx(measure.cad, rel=1e-12)
    assert [(m.name, m.parts) for m in report.surfaces] == [
        ("casting/outside", 5),
        ("die/outside", 6),
    ]
    assert [(m.name, m.cad) for m in report.interfaces] == [("casting/die", pytest.approx(4e-4))]
    assert Report.of_data(json.loads(json.dumps(report.as_data()))) == report


def test_round_parts_lie_between_a_polygon_and_cad(tmp_path):
    report = reported(str(tmp_path / "sizes"), bush_in_ring, 0.02, 24.0, "bush", "ring")
    bush = report.bodies[0]
    assert bush.cad == pytest.approx(pi * 0.01**2 * 0.012, rel=1e-9)
    polygon = sin(2 * pi / 24) / (2 * pi / 24)
    assert polygon < bush.mesh / bush.cad < 0.999
    assert polygon < report.interfaces[0].mesh / report.interfaces[0].cad < 0.9999
