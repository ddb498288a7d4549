"""CAD files as the geometry of a case."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.cad.geometry import CadGeometry, is_cad_file
from castx.case.geometry import Geometry
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial

STEP = {"model": "3d", "file": "part.step", "size": "4 mm"}

LOCAL = {"sizes": [{"surface": "tip", "size": 1e-3}]}


def test_keys_stand_beside_the_file():
    geometry = Geometry.read(
        {**STEP, "tolerance": "0.01 mm", "names": {"Part 1": "casting"}, "curvature": 30,
         "surfaces": {"top": {"normal": "+z"}}}
    )  # fmt: skip
    assert geometry.cad is not None and geometry.file is None and geometry.surfaces is None
    assert geometry.cad.sources == [(Path("part.step"), None)]
    assert (geometry.cad.size, geometry.cad.tolerance) == (0.004, 1e-5)
    assert geometry.cad.surfaces["top"].normal == (0.0, 0.0, 1.0)


def test_files_are_relative_to_a_folder():
    parts = {"casting": "a.stp", "mould": "/b.IGS"}
    cad = CadGeometry.read({"parts": parts, "size": 1}).relative_to(Path("/case"))
    assert cad.sources == [(Path("/case/a.stp"), "casting"), (Path("/b.IGS"), "mould")]
    cad = CadGeometry.read({"files": ["a.brep"], "size": 1, "unit": "inch"})
    assert cad.unit == pytest.approx(0.0254)
    assert cad.relative_to(Path("/case")).sources == [(Path("/case/a.brep"), None)]
    assert cad.relative_to(Path("/case")).size_map is None
    mapped = CadGeometry.read({"file": "a.step", "size": 1, "size_map": "b/sizes.vtu"})
    assert mapped.relative_to(Path("/case")).size_map == Path("/case/b/sizes.vtu")


def test_ends_of_names():
    assert is_cad_file("a.STEP") and is_cad_file(Path("a.igs"))
    assert not is_cad_file("a.msh") and not is_cad_file(3)


@pytest.mark.parametrize(
    "description, text",
    [
        ({**STEP, "model": "axisymmetric"}, 'model: CAD solids need the model "3d"'),
        ({"model": "3d", "file": "part.step"}, "size: missing"),
        ({**STEP, "files": ["b.step"]}, "give one of file, files and parts"),
        ({"model": "3d", "files": [], "size": 1}, "files: a list of 1 to 100 CAD files"),
        ({"model": "3d", "files": ["a.msh"], "size": 1}, r"files\[0\]: the path of a CAD file"),
        ({"model": "3d", "parts": {"a": "a.txt"}, "size": 1}, "parts.a: the path of a CAD file"),
        ({**STEP, "generator": "slab"}, "give either a generator or a mesh"),
        ({**STEP, "sise": 1}, 'sise: unknown key.*mean "size"'),
        ({**STEP, "cad": 1}, "cad: unknown key"),
        ({**STEP, "unit": "mm"}, "unit: STEP and IGES files carry their own unit"),
        ({"model": "3d", "file": "a.brep", "size": 1, "unit": 3}, "unit: a unit of length"),
        ({"model": "3d", "file": "a.brep", "size": 1, "unit": "kg"}, "unit: "),
        ({**STEP, "tolerance": "3 mm"}, "tolerance: must be at most half of size, 0.004 m"),
        ({**STEP, "tolerance": "1 mm", "refinement": 4}, "must be at most half of size, 0.001 m"),
        ({**STEP, "refinement": 0}, "refinement: must be at least 0.1"),
        ({**STEP, "size": 0}, "size: must be positive"),
        ({**STEP, "curvature": 2}, "curvature: must be at least 3"),
        ({**STEP, "across": -1}, "across: a whole number from 0 to 20"),
        ({**STEP, "size_map": "a.csv"}, "size_map: the path of a VTU file with sizes is needed"),
        ({**STEP, "growth": 0}, "growth: must be at least 0.05"),
        ({**STEP, "most_cells": 0}, "most_cells: must be at least 1"),
        ({**STEP, "interface_size": 1}, "interface_size: must not exceed size, 0.004 m"),
        ({**STEP, "sizes": [{"body": "a", "size": 1}]}, r"sizes\[0\].size: must not exceed size"),
        (
            {
                **STEP,
                "sizes": [{"surface": "tip", "size": 1e-3}],
                "surfaces": {"top": {"largest": 1}},
            },
            r"sizes\[0\].surface: no such surface; surfaces: top",
        ),
        ({**STEP, "surfaces": ["top"]}, "surfaces: a table is needed"),
        ({**STEP, "surfaces": {"top": {"radius": 0}}}, "surfaces.top.radius: must be positive"),
        ({**STEP, "surfaces": {"a/b": {"largest": 1}}}, 'surfaces."a/b": a name has 1 to 64'),
        ({**STEP, "names": {"A": "a/b"}}, "names.A: a name has 1 to 64 letters"),
    ],
)
def test_refused(description, text):
    with pytest.raises(Refusal, match=text):
        Geometry.read(description)


def test_a_size_at_interfaces_is_a_number_here():
    cad = Geometry.read({**STEP, "interface_size": "1.5 mm"}).cad
    assert cad is not None and cad.interface_size == 0.0015
    with pytest.raises(Refusal, match="castx new writes one, and castx check says which"):
        Geometry.read({**STEP, "interface_size": "auto"})
