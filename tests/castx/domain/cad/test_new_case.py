"""What a first case file says of a CAD part is what the part is."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

from mpi4py import MPI

import gmsh
import pytest

from castx.case.cad.template import case_text
from castx.case.reading.read import load_case
from castx.coupling.loose_parts import loose_parts
from castx.domain.cad import first_mesh as first_mesh_module
from castx.domain.cad import new_case as new_case_module
from castx.domain.cad.new_case import (
    Wanted,
    new_case,
    shell_of,
    write_new_case,
)
from castx.domain.mesh import build_mesh
from castx.domain.pairs.pairing import case_pairs
from castx.domain.source import named_mesh
from castx.errors import CaseError, MeshError
from castx.meshes.cad.description import CadFile, CadPart
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


def test_a_mould_that_is_made_is_measured_by_the_casting(tmp_path):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 40, 10, 10)])
    case = new_case(path, tmp_path / "bar.toml", Wanted("investment"))
    area, edges, thickness = 18e-4, 0.24, 0.008  # of the bar, and of the shell round it
    ball = 4 / 3 * math.pi * thickness**3
    volume = area * thickness + edges * math.pi / 4 * thickness**2 + ball
    outside = area + edges * math.pi / 2 * thickness + 3 * ball / thickness
    shell = shell_of(case)
    # one cell through it cuts its rounds
    assert shell.volume == pytest.approx(volume / area, rel=0.1)
    assert shell.outside == pytest.approx(outside / area, rel=0.1)
    assert shell_of(replace(case, margin=None)) is None


def test_investment_castings_have_a_shell_that_follows_them(tmp_path):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 40, 10, 10)])
    target = tmp_path / "bar.toml"
    text = case_text(new_case(path, target, Wanted("investment")))
    assert 'mould = { shell = "8 mm" }      # a shell that follows the part\n' in text
    above = case_text(new_case(path, target, Wanted("investment", open_top=True)))
    assert (
        "mould = { box = [[-0.01, -0.01, -0.01], [0.05, 0.02, 0.01]], "
        'shell = "8 mm" }      # a shell that follows the part\n'
    ) in above
    block = case_text(new_case(path, target, Wanted("gravity-die")))
    assert "# a block round the part" in block and "shell" not in block


def test_walls_that_alone_ask_for_many_cells_are_taken_as_they_come(tmp_path, monkeypatch):
    def thin(occ):
        block, pocket = occ.addBox(0, 0, 0, 120, 40, 10), occ.addBox(0.6, 15, 4, 9, 10, 6)
        ((_, part),), _ = occ.cut([(3, block)], [(3, pocket)], removeTool=False)
        return [part, pocket]

    path = write_cad(tmp_path / "thin.step", thin, ["part", "pin"])
    assert "\nacross = 1 " in case_text(new_case(path, tmp_path / "a.toml"))
    monkeypatch.setattr("castx.domain.cad.first_mesh.FIRST_CELLS", 3e3)
    assert "\nacross = 0 " in case_text(new_case(path, tmp_path / "a.toml"))


def test_many_cells_grow_faster_away_from_walls(tmp_path, monkeypatch):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 80, 60, 4)])
    said, counts = [], []
    for affordable in (1e5, 4000):
        monkeypatch.setattr(first_mesh_module, "AFFORDABLE", affordable)
        case = new_case(path, tmp_path / "a.toml", say=said.append)
        (tmp_path / "a.toml").write_text(case_text(case))
        geometry = load_case(tmp_path / "a.toml").geometry
        mesh = named_mesh(geometry, ["bar", "mould"])
        counts.append([int((mesh.bodies == body).sum()) for body in (0, 1)])
        assert geometry.cad.growth == (case.growth or 0.4)
    assert case.growth == 1.0 and "\ngrowth = 1 " in case_text(case)
    (bar, mould), (grown_bar, grown_mould) = counts
    assert grown_mould < 0.9 * mould and grown_bar > 0.95 * bar
    assert said[-1].startswith(f"{bar + mould} cells; {grown_bar + grown_mould} with growth = 1")
    # walls as they come have a cell across all the same
    monkeypatch.setattr(first_mesh_module, "AFFORDABLE", 100)
    assert new_case(path, tmp_path / "a.toml", say=said.append).across == 0
    assert "with across = 0, by which walls have one across all the same" in said[-1]
    # where little is gained, all is left as it is
    monkeypatch.setattr(first_mesh_module, "WORTH", 0.1)
    assert new_case(path, tmp_path / "a.toml").growth is None


def bow_tie(occ):
    """A prism whose section crosses itself, so that its two halves have opposite volumes."""
    corners = [occ.addPoint(*p) for p in ((0, 0, 0), (20, 10, 0), (20, 0, 0), (0, 10, 0))]
    return extruded(occ, corners)


def extruded(occ, corners):
    ends = [*corners[1:], corners[0]]
    lines = [occ.addLine(a, b) for a, b in zip(corners, ends, strict=True)]
    section = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    return [tag for dim, tag in occ.extrude([(2, section)], 0, 0, 10) if dim == 3]


def dented(occ):
    """A cube of triangles, one corner of which is pushed through the opposite side."""
    places = [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0),
              (0, 0, 10), (10, 0, 10), (10, 10, -4), (0, 10, 10)]  # fmt: skip
    points = [occ.addPoint(*place) for place in places]
    lines: dict[frozenset[int], int] = {}
    faces = []
    for a, b, c in ((0, 2, 1), (0, 3, 2), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5),
                    (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7), (4, 5, 6), (4, 6, 7)):  # fmt: skip
        for i, j in ((a, b), (b, c), (c, a)):
            if frozenset((i, j)) not in lines:
                lines[frozenset((i, j))] = occ.addLine(points[i], points[j])
        loop = [lines[frozenset(pair)] for pair in ((a, b), (b, c), (c, a))]
        faces.append(occ.addPlaneSurface([occ.addCurveLoop(loop)]))
    return [occ.addVolume([occ.addSurfaceLoop(faces)])]


def sheet(occ):
    occ.addRectangle(0, 0, 0, 10, 20)
    return []


@pytest.mark.sampled
@pytest.mark.parametrize(
    "solids, text",
    [
        (bow_tie, r"'part' round \([-.\d]+, .*\) m has no volume .*; repair it in CAD"),
        (dented, r"part\.step: gmsh cannot mesh .* \(0\.\d+, .*\) m; .*intersect.*repair"),
        (sheet, r"part\.step has 1 surfaces and no solid, .* export each part as a solid"),
        (b"", r"part\.step is empty; export it again"),
        (b"solid a\nfacet normal 0 0 1\n", r"part\.step is no STEP file: .*do not rename files"),
        (b"ISO-10303-21;\nHEADER;\n", r"part\.step cannot be read: .* export it again"),
    ],
)
def test_bad_files_are_refused_with_file_and_cure(tmp_path, solids, text):
    path = tmp_path / "part.step"
    if isinstance(solids, bytes):
        path.write_bytes(solids)
    else:
        write_cad(path, solids)
    with pytest.raises(MeshError, match=text):
        write_new_case(path, tmp_path / "part.toml")
    assert not (tmp_path / "part.toml").exists()


def test_a_solid_turned_inside_out_is_refused(tmp_path):
    path = write_cad(tmp_path / "part.brep", lambda occ: [occ.addBox(0, 0, 0, 10, 10, 10)])
    before, found, solid = path.read_text().rpartition("\nSo\n")
    assert found and solid.count("+3 0") == 1
    path.write_text(before + found + solid.replace("+3 0", "-3 0"))
    with pytest.raises(MeshError, match="m has no volume or is turned inside out; repair it"):
        write_new_case(path, tmp_path / "part.toml")


def test_the_top_of_a_casting_is_open_and_its_mould_has_halves(tmp_path):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 3, 40, 10, 10)])
    said = []
    wanted = Wanted("sand", "AlSi7Mg", "sand-chromite", "z", open_top=True)
    write_new_case(path, tmp_path / "bar.toml", wanted, said.append)
    case = load_case(tmp_path / "bar.toml")
    assert case.geometry.cad.mould.split == (2, pytest.approx(0.008))
    low, high = case.geometry.cad.mould.box
    assert low == pytest.approx((-0.01, -0.01, -0.007))
    assert high == pytest.approx((0.05, 0.02, 0.013))
    assert [body.name for body in case.bodies] == ["bar", "mould-low", "mould-high"]
    assert [body.material for body in case.bodies] == ["AlSi7Mg", *["sand-chromite"] * 2]
    assert "bar/outside" in [boundary.on for boundary in case.boundaries]
    assert said[0].startswith("meshing bar.step") and said[-1].startswith("bar: 40 × 10 × 10 mm")
    placed = new_case(path, tmp_path / "b.toml", replace(wanted, split="z=12mm"))
    assert 'split = "z = 12 mm"' in placed.mould


def box(occ):
    """An open box of 60 x 40 x 30 with walls of 5."""
    ((_, part),), _ = occ.cut(
        [(3, occ.addBox(0, 0, 0, 60, 40, 30))], [(3, occ.addBox(5, 5, 5, 50, 30, 30))]
    )
    return [part]


@pytest.mark.parametrize(
    "process, split, holds", [("gravity-die", "z", True), ("sand", None, True), (None, "z", True),
                              ("investment", None, False)],
)  # fmt: skip
def test_the_plug_of_an_open_box_hangs_on_a_frame(tmp_path, process, split, holds):
    """It touches the casting alone, and nothing else kept its place; a rigid shell does."""
    path = write_cad(tmp_path / "box.step", box)
    wanted = Wanted(process, split=split, open_top=True)
    write_new_case(path, tmp_path / "box.toml", wanted)
    case = load_case(tmp_path / "box.toml")
    assert case.geometry.cad.mould.plug == "mould-plug"
    others = ["mould"] if split is None else ["mould-low", "mould-high"]
    assert {body.name for body in case.bodies} == {"box", "mould-plug", *others}
    clamps = {boundary.on: boundary.clamp for boundary in case.boundaries if boundary.clamp}
    assert set(clamps) == ({"mould-plug/outside", f"{others[0]}/outside"} if holds else set())
    assert all(clamp.is_frame for clamp in clamps.values())
    if process is not None:
        assert {*others, "mould-plug"} == {name for s in case.stages for name in s.remove}
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], MPI.COMM_SELF)
    assert list(loose_parts(case, mesh, case_pairs(mesh, case.interfaces))) == []
    closed = new_case(path, tmp_path / "b.toml", replace(wanted, open_top=False))
    assert "plug" not in closed.mould and "mould-plug" not in dict(closed.bodies)


@pytest.mark.parametrize("step, place, told", [(10.3, "10.3", True), (12.0, "10", False)])
def test_a_mould_parts_at_a_face_near_the_middle(tmp_path, step, place, told):
    """Else a sliver of it lies between the face and the plane, which takes tiny cells."""

    def stepped(occ):
        block, out = occ.addBox(0, 0, 0, 60, 30, 20), occ.addBox(30, -1, step, 40, 40, 20)
        ((_, part),), _ = occ.cut([(3, block)], [(3, out)])
        return [part]

    path, said = write_cad(tmp_path / "part.step", stepped), []
    case = new_case(path, tmp_path / "a.toml", Wanted("gravity-die", split="z"), said.append)
    assert f'split = "z = {place} mm"' in case.mould
    assert ("the mould parts at z = 10.3 mm, a face near its middle" in said) == told
    fixed = new_case(path, tmp_path / "a.toml", Wanted("gravity-die", split="z=10mm"))
    assert 'split = "z = 10 mm"' in fixed.mould


def cored(occ):
    """A block with a core that stands out of its two ends."""
    core = (3, occ.addBox(-5, 3, 3, 50, 4, 4))
    occ.fragment([(3, occ.addBox(0, 0, 0, 40, 10, 10))], [core])
    occ.synchronize()
    inside = [tag for _, tag in gmsh.model.getEntities(3) if 5 < occ.getMass(3, tag) < 900]
    ((_, whole),), _ = occ.fuse([(3, inside[0])], [(3, tag) for tag in inside[1:]])
    return [*(tag for _, tag in gmsh.model.getEntities(3) if tag != whole and tag not in inside),
            whole]  # fmt: skip


def test_a_casting_with_its_core_gets_a_mould_round_both(tmp_path):
    path, said = write_cad(tmp_path / "pipe.step", cored, ["pipe", "core"]), []
    wanted = Wanted("sand", "AlSi7Mg", split="z", open_top=True)
    write_new_case(path, tmp_path / "pipe.toml", wanted, said.append)
    case = load_case(tmp_path / "pipe.toml")
    names = ["pipe", "core", "mould-low", "mould-high"]
    assert [body.name for body in case.bodies] == names
    low, high = case.geometry.cad.mould.box
    assert low == pytest.approx((-0.017, -0.012, -0.012))  # a quarter of 50 mm, rounded
    assert high == pytest.approx((0.057, 0.022, 0.01))
    assert {"pipe/core", "core/mould-low", "pipe/mould-high"} < {i.name for i in case.interfaces}
    assert said[1] == "meshing it again, in a mould"
    assert said[2].startswith("cells of 1.2 mm at interfaces: core takes up the heat of freezing")
    assert said[3].startswith("by their names and their order, pipe: cast, core: a core; ")


@pytest.mark.parametrize(
    "low, high, place",
    [(-0.038, 0.06001, 0.011), (-0.01199, 0.012, 0.0), (0.003, 0.0131, 0.008), (-1.0, 1.3, 0.15)],
)
def test_a_mould_parts_at_a_round_number(tmp_path, monkeypatch, low, high, place):
    """Meshes of round parts have boxes that are off by the height of a chord."""
    report = SimpleNamespace(
        bodies=[SimpleNamespace(name="part", cad=1e-5)], interfaces=[], size=0.01, extent=0.1,
        surfaces=[SimpleNamespace(name="part/outside", cad=1e-2)],
        boxes={"part": ((0.0, 0.0, low), (0.1, 0.1, high))}, quality=SimpleNamespace(cells=900),
    )  # fmt: skip
    part = CadPart((CadFile("a.step"),), 0.01, across=0)
    found = first_mesh_module.FirstMesh(report, part)
    monkeypatch.setattr(new_case_module, "survey", lambda *_: found)
    case = new_case(tmp_path / "a.step", tmp_path / "a.toml", Wanted("sand", split="z"))
    assert f'split = "z = {1e3 * place:.5g} mm"' in case.mould


@pytest.mark.parametrize(
    "split, text",
    [
        (
            "z=70mm",
            r"--split: z=70mm lies at 70 mm and misses the part, from z = 0 to 20 mm; lengths",
        ),
        ("z=-1mm", "z=-1mm lies at -1 mm and misses"),
        ("z=12", "z=12 lies at 12000 mm and misses the part, .* without a unit are metres"),
        ("z=12 mmm", '--split: z=12 mmm: 12 mmm is no length; write "z=12mm"'),
        ("z=", "a plane across x, y or z is needed"),
    ],
)
def test_a_plane_that_cuts_no_part_is_refused(tmp_path, split, text):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 50, 30, 20)])
    with pytest.raises(CaseError, match=text):
        write_new_case(path, tmp_path / "a.toml", Wanted("sand", split=split))


def test_a_mould_may_part_at_the_foot_of_a_part_without_a_unit(tmp_path):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 50, 30, 20)])
    case = new_case(path, tmp_path / "a.toml", Wanted("sand", split="z=0"))
    assert 'split = "z = 0 mm"' in case.mould


@pytest.mark.parametrize(
    "wanted, text",
    [
        (Wanted(alloy="AlSi7Mg"), "--alloy and --mould need --process"),
        (Wanted(split="z"), r"--split and --top act on a mould .* bodies casting, die"),
        (
            Wanted("high-pressure-die", open_top=True),
            "--top open: not with high-pressure-die: a die is closed while .*; leave it out, or "
            "choose a process that has it: gravity-die, investment, sand",
        ),
        (Wanted("investment", split="z"), "--split: not with investment: a shell is one piece"),
        (Wanted("continuous", split="z"), "--split: not with continuous: a strand runs through"),
        (Wanted("continuous", open_top=True), "--top open: not with continuous: .* has no top"),
    ],
)
def test_what_does_not_go_together_is_refused(tmp_path, wanted, text):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    with pytest.raises(CaseError, match=text):
        write_new_case(path, tmp_path / "a.toml", wanted)


def test_an_alloy_without_an_interface_is_refused_before_anything_is_meshed(tmp_path):
    path, said = write_cad(tmp_path / "bar.step", two_blocks), []
    with pytest.raises(CaseError, match="no heat transfer between magnesium and the mould of sand"):
        write_new_case(path, tmp_path / "a.toml", Wanted("sand", alloy="AZ91"), said.append)
    assert said == []


def grooved(occ):
    """A shaft of 30 mm with 12 grooves of 0.2 x 0.2 mm."""
    shaft = occ.addCylinder(0, 0, 0, 0, 0, 30, 10)
    rings = []
    for number in range(12):
        whole, core = (occ.addCylinder(0, 0, 2 + 2 * number, 0, 0, 0.2, r) for r in (11, 9.8))
        rings += occ.cut([(3, whole)], [(3, core)])[0]
    ((_, part),), _ = occ.cut([(3, shaft)], rings)
    return [part]


def test_a_grooved_shaft_gets_a_case_without_its_grooves(tmp_path, monkeypatch):
    monkeypatch.setattr(first_mesh_module, "FIRST_CELLS", 1e4)
    path, said = write_cad(tmp_path / "shaft.step", grooved), []
    write_new_case(path, tmp_path / "a.toml", Wanted("gravity-die"), said.append)
    text = (tmp_path / "a.toml").read_text()
    assert 'narrowest = "1 mm"' in text and "tolerance" not in text
    assert load_case(tmp_path / "a.toml").geometry.cad.narrowest == 1e-3
    assert said[-1].startswith("shaft: 20 × 20 × 30 mm, 9.425 cm³")  # π r² h: no groove


def test_a_damaged_file_is_read_once(tmp_path):
    path, said = tmp_path / "part.step", []
    path.write_bytes(b"")
    with pytest.raises(MeshError, match=r"is empty; export it again$"):
        new_case(path, tmp_path / "a.toml", say=said.append)
    assert said == ["meshing part.step, coarsely, to see its bodies and faces"]


def test_refused(tmp_path):
    with pytest.raises(CaseError, match=r"part.msh: a CAD file is needed: \.step"):
        write_new_case(tmp_path / "part.msh", tmp_path / "a.toml")
    (tmp_path / "a.toml").write_text("")
    with pytest.raises(CaseError, match=r"a\.toml exists; give another one with --output"):
        write_new_case(tmp_path / "part.step", tmp_path / "a.toml")
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 9, 9, 9)])
    with pytest.raises(CaseError, match=r"cannot write .*nowhere/a\.toml: No such file"):
        write_new_case(path, tmp_path / "nowhere" / "a.toml")
