"""Solids are read with their units and labels; what is no CAD file is refused with its cure."""

from __future__ import annotations

from math import pi

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.description import CadFile
from castx.meshes.cad.reading import clean, numbered, place_text, read_solids
from tests.cad_files import MILLIMETRE, in_inches, rounded_block, two_blocks, write_cad

pytestmark = pytest.mark.serial


def volumes(path, names=None, **file):
    """Names and volumes [mm³] of the solids of a file."""
    with gmsh_session():
        solids = read_solids([CadFile(str(path), **file)], names or {})
        return {solid.name: gmsh.model.occ.getMass(3, solid.tag) for solid in solids}


def test_labels_name_the_solids(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    assert volumes(path) == pytest.approx({"casting": 4000.0, "die": 6000.0}, rel=1e-12)


def test_a_table_renames_labels_and_orders(tmp_path):
    path = write_cad(tmp_path / "two.stp", two_blocks, ["upper", "die"])
    found = volumes(path, {"upper": "casting", "solid-2": "mould"})
    assert found == pytest.approx({"casting": 4000.0, "mould": 6000.0}, rel=1e-12)
    with pytest.raises(ValueError, match=r"no solid has the label 'uper'; there are:\n.*'upper'"):
        volumes(path, {"uper": "casting"})


def test_solids_without_label_have_their_order(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks)
    assert list(volumes(path)) == ["solid-1", "solid-2"]


def test_the_only_solid_of_a_file_is_called_like_it(tmp_path):
    first = write_cad(tmp_path / "gear wheel.v2.step", lambda occ: [occ.addBox(0, 0, 0, 9, 9, 9)])
    assert list(volumes(first)) == ["gear wheel-v2"]
    assert list(volumes(first, {"solid-1": "casting"})) == ["casting"]
    assert list(volumes(first, body="die")) == ["die"]
    labelled = write_cad(tmp_path / "x.step", lambda occ: [occ.addBox(9, 0, 0, 9, 9, 9)], ["core"])
    second = write_cad(tmp_path / "core.brep", lambda occ: [occ.addBox(0, 9, 0, 9, 9, 9)])
    with gmsh_session():
        solids = read_solids([CadFile(str(path)) for path in (first, labelled, second)], {})
        assert [solid.name for solid in solids] == ["gear wheel-v2", "core-1", "core-2"]
        assert [solid.label for solid in solids] == ["", "core", ""]


@pytest.mark.parametrize(
    "labels, names",
    [
        (["a", "b"], ["a", "b"]),
        (["pin", "die", "pin"], ["pin-1", "die", "pin-2"]),
        (["", "die"], ["solid-1", "die"]),
        (["a/b.c", "Kern Öl"], ["a-b-c", "Kern Öl"]),
    ],
)
def test_names_from_labels(labels, names):
    assert [numbered(labels, index) for index in range(len(labels))] == names
    assert len(clean("x" * 99)) == 64


def test_units_are_converted(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    in_inches(path)
    assert volumes(path)["casting"] == pytest.approx(4000.0 * 25.4**3, rel=1e-10)
    metres = write_cad(tmp_path / "metres.step", two_blocks, ["casting", "die"])
    metres.write_text(metres.read_text().replace(MILLIMETRE, "SI_UNIT($,.METRE.)"))
    assert volumes(metres)["casting"] == pytest.approx(4e12, rel=1e-10)


def test_brep_takes_its_unit_from_the_description(tmp_path):
    path = write_cad(tmp_path / "two.brep", two_blocks)
    assert volumes(path)["solid-1"] == pytest.approx(4000.0, rel=1e-12)
    assert volumes(path, unit=0.01)["solid-1"] == pytest.approx(4e6, rel=1e-12)


def test_surfaces_that_enclose_a_solid_are_sewn_file_by_file(tmp_path):
    def lower(occ):
        return [occ.addBox(0, 0, -10, 30, 20, 10)]

    files = [
        CadFile(str(write_cad(tmp_path / "upper.igs", rounded_block)), "upper"),
        CadFile(str(write_cad(tmp_path / "lower.iges", lower)), "lower"),
    ]
    with gmsh_session():
        solids = read_solids(files, {}, str(tmp_path / "sewn.brep"))
        found = {solid.name: gmsh.model.occ.getMass(3, solid.tag) for solid in solids}
        assert len(gmsh.model.getEntities(2)) == 10 + 6
    rounded = 10 * (600 - (4 - pi) * 16)
    assert found == pytest.approx({"upper": rounded, "lower": 6000.0}, rel=1e-9)


def test_surfaces_of_touching_solids_in_one_file_are_refused(tmp_path):
    path = write_cad(tmp_path / "two.igs", two_blocks)
    with pytest.raises(ValueError, match="12 surfaces and no solid, and they enclose none one by"):
        volumes(path)


def test_open_surfaces_are_refused(tmp_path):
    def faces(occ):
        occ.addRectangle(0, 0, 0, 10, 20)
        return []

    path = write_cad(tmp_path / "sheet.step", faces)
    with pytest.raises(ValueError, match="has 1 surfaces and no solid, and they enclose none"):
        volumes(path)


@pytest.mark.parametrize(
    "name, content, text",
    [
        ("none.step", None, "cannot read the CAD file .*No such file"),
        ("zero.step", b"", "is empty; export it again"),
        ("text.step", b"a letter\n" * 9, "is no STEP file: it begins with b'a letter"),
        ("text.brep", b"a letter\n" * 9, "is no BREP file"),
        ("text.iges", b"a letter\n" * 9, "is no IGES file"),
        ("begun.step", b"ISO-10303-21;\nHEADER;\n", "cannot be read: .*export it again"),
        (
            "empty.step",
            b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),"
            b"'','','');\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\nENDSEC;\n"
            b"END-ISO-10303-21;\n",
            "has no solids; export|cannot be read",
        ),
    ],
)
def test_what_is_no_cad_file_is_refused(tmp_path, name, content, text):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ValueError, match=text):
        volumes(path)


def test_a_place_has_no_rest_of_rounding():
    assert place_text(np.array([-6.466e-16, 0.12345678, 2e-6])) == "(0, 0.1235, 2e-06) m"
