"""Moulds made round solids have the volumes and areas that geometry gives them."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.description import (
    CadFile,
    CadPart,
    Channel,
    Chill,
    Mould,
    SymmetryPlane,
)
from castx.meshes.cad.mould import distances_to_line
from castx.meshes.cad.part import mesh_part
from tests.cad_files import write_cad

pytestmark = pytest.mark.serial


def bar(occ):
    """A bar of 40 x 20 x 20."""
    return [occ.addBox(0, 0, 0, 40, 20, 20)]


def bar_with_core(occ):
    """The bar, and a core of 60 x 10 x 10 through its middle."""
    return [*bar(occ), occ.addBox(-10, 5, 5, 60, 10, 10)]


def cup(occ):
    """The bar with a pocket of 30 x 10 x 15 from above."""
    pocket = occ.addBox(5, 5, 5, 30, 10, 15)
    cut, _ = occ.cut([(3, tag) for tag in bar(occ)], [(3, pocket)])
    return [tag for _, tag in cut]


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mould")
    alone = write_cad(folder / "bar.step", bar, ["casting"])
    both = write_cad(folder / "both.step", bar_with_core, ["casting", "core"])

    def report(mould, *, core=False, **changes):
        file = CadFile(str(both if core else alone), None if core else "casting")
        part = CadPart((file,), 0.03, across=1, curvature=6, growth=2.0, mould=mould, **changes)
        with gmsh_session():
            found = mesh_part(part, str(folder / "a.msh"))
        kinds = (found.bodies, found.interfaces, found.surfaces)
        return found, *({m.name: m.cad for m in kind} for kind in kinds)

    return report


def test_two_halves_with_a_channel_and_a_chill(reported):
    mould = Mould(
        margin=0.02,
        split=(2, 0.01),
        channels=(Channel("cooling", ((-1.0, 0.01, -0.01), (1.0, 0.01, -0.01)), 0.004),),
        chills=(Chill("chill", ((0.01, 0.005, 0.015), (0.03, 0.015, 0.025))),),
    )
    _, bodies, interfaces, surfaces = reported(mould)
    chill = 20 * 10 * 5.0
    channel = pi * 2**2 * 80
    assert bodies == pytest.approx(
        {
            "casting": 16000e-9,
            "chill": chill * 1e-9,
            "mould-low": (80 * 60 * 30 - 8000 - channel) * 1e-9,
            "mould-high": (80 * 60 * 35 - 8000 - chill) * 1e-9,
        },
        rel=1e-6,
    )
    assert interfaces == pytest.approx(
        {
            "casting/chill": 200e-6,
            "casting/mould-low": (800 + 1200) * 1e-6,
            "casting/mould-high": (600 + 1200) * 1e-6,
            "chill/mould-high": (200 + 2 * 50 + 2 * 100) * 1e-6,
            "mould-high/mould-low": (80 * 60 - 800) * 1e-6,
        },
        rel=1e-6,
    )
    assert surfaces["mould-low/cooling"] == pytest.approx(pi * 4 * 80 * 1e-6, rel=1e-6)
    ends = 2 * pi * 2**2
    assert surfaces["mould-low/outside"] == pytest.approx(
        (80 * 60 + 2 * 140 * 30 - ends) * 1e-6, rel=1e-6
    )


def test_a_core_is_cut_out_of_the_casting_and_planes_cut_everything(reported):
    mould = Mould(box=((-0.02, -0.01, -0.01), (0.06, 0.03, 0.02)), cores=("core",))
    planes = (SymmetryPlane(0, 0.02, True), SymmetryPlane(1, 0.01, False))
    found, bodies, interfaces, surfaces = reported(mould, core=True, symmetry=planes)
    assert bodies == pytest.approx(
        {
            "casting": (16000 - 4000) / 4 * 1e-9,
            "core": 6000 / 4 * 1e-9,
            "mould": (80 * 40 * 30 - 16000 - 2000) / 4 * 1e-9,
        },
        rel=1e-9,
    )
    assert interfaces["casting/core"] == pytest.approx(40 * 40 / 4 * 1e-6, rel=1e-9)
    assert surfaces["casting/outside"] == pytest.approx(20 * 10 * 1e-6, rel=1e-9)  # open above
    assert surfaces["mould/symmetry-x"] == pytest.approx((20 * 30 - 10 * 20) * 1e-6, rel=1e-9)
    assert surfaces["core/symmetry-y"] == pytest.approx(30 * 10 * 1e-6, rel=1e-9)
    for measure in (*found.bodies, *found.surfaces, *found.interfaces):
        assert measure.mesh == pytest.approx(measure.cad, rel=1e-10)


def test_a_bent_channel_and_a_round_chill(reported):
    line = ((-0.01, 0.01, -1.0), (-0.01, 0.01, 0.01), (-0.01, -1.0, 0.01))
    mould = Mould(
        margin=0.02,
        channels=(Channel("bend", line, 0.004),),
        chills=(Chill("pin", line=((0.02, 0.01, 0.01), (0.02, 0.01, 0.03)), diameter=0.008),),
    )
    _, bodies, _, surfaces = reported(mould)
    assert bodies["pin"] == pytest.approx(pi * 16 * 10 * 1e-9, rel=1e-6)
    # Two cylinders that meet at a right angle have the area of one along the bent axis, in which
    # the inner corner loses what the outer one, a part of a ball, gains but for (π² - 8) r²/π.
    straight = 2 * pi * 2 * (30 + 30) * 1e-6
    assert surfaces["mould/bend"] == pytest.approx(straight, rel=0.02)
    # Both cylinders end in the bend, have a quarter of the body of two in common, 16 r³/3, and
    # leave a quarter of the ball free.
    channel = pi * 2**2 * 60 - 4 / 3 * 2**3 + pi / 3 * 2**3
    mould_alone = 80 * 60 * 70 - 40 * 20 * 20 - channel - pi * 16 * 10
    assert bodies["mould"] == pytest.approx(mould_alone * 1e-9, rel=1e-8)


@pytest.mark.parametrize("upwards", [True, False])
@pytest.mark.parametrize("split", [10, 20])
def test_the_plug_of_a_cup_hangs_at_the_half_that_it_touches(tmp_path, split, upwards):
    """The plane of the split cuts it off from its own half, at the rim the whole of it."""

    def turned(occ, solids):
        if not upwards:
            occ.rotate(solids, 20, 10, 10, 1, 0, 0, pi)

    file = write_cad(tmp_path / "cup.step", cup, ["casting"], turned)
    place = 1e-3 * (split if upwards else 20 - split)
    mould = Mould(margin=0.02, split=(2, place))
    part = CadPart((CadFile(str(file), "casting"),), 0.03, across=1, growth=2.0, mould=mould)
    with gmsh_session():
        found = mesh_part(part, str(tmp_path / "a.msh"))
    bodies = {body.name: body.cad for body in found.bodies}
    plug, block = 30 * 10 * (split - 5), 80 * 60
    closed = block * (20 + split) - 40 * 20 * split
    opened = block * (40 - split) - 40 * 20 * (20 - split) + 30 * 10 * (20 - split) + plug
    names = ("mould-low", "mould-high") if upwards else ("mould-high", "mould-low")
    expected = dict(zip(names, (closed, opened), strict=True))
    assert {name: bodies[name] for name in names} == pytest.approx(
        {name: volume * 1e-9 for name, volume in expected.items()}, rel=1e-6
    )
    (told,) = [remark for remark in found.remarks if remark.startswith("split")]
    assert told.startswith(f"split cuts 1 piece off from {names[0]!r}, round (0.02, 0.01, ")
    assert told.endswith(f"{names[1]!r} has them, the half that they hang at")


@pytest.mark.parametrize("split, half", [(8, 1), (16, 0)])
def test_the_plug_of_a_cup_with_a_bare_rim_stays_whole(tmp_path, split, half):
    """It touches neither half, and goes with the one in which more of it lies."""
    file = write_cad(tmp_path / "cup.step", cup, ["casting"])
    box = ((-0.02, -0.02, -0.02), (0.06, 0.04, 0.02))
    mould = Mould(box=box, split=(2, 1e-3 * split))
    part = CadPart((CadFile(str(file), "casting"),), 0.03, across=1, growth=2.0, mould=mould)
    with gmsh_session():
        found = mesh_part(part, str(tmp_path / "a.msh"))
    bodies = {body.name: body.cad for body in found.bodies}
    expected = [80 * 60 * (20 + split) - 40 * 20 * split, (80 * 60 - 40 * 20) * (20 - split)]
    expected[half] += 30 * 10 * 15
    assert [bodies["mould-low"], bodies["mould-high"]] == pytest.approx(
        [volume * 1e-9 for volume in expected], rel=1e-6
    )
    (told,) = [remark for remark in found.remarks if remark.startswith("split")]
    name = ("mould-low", "mould-high")[half]
    assert told.startswith("split cuts 1 piece in two that touches neither half, round (0.02, 0.01")
    assert told.endswith(f"{name!r} has it, the half in which more of it lies")


@pytest.mark.parametrize("split", [None, (2, 8e-3)])
def test_a_plug_that_touches_no_outer_part_may_be_a_body_of_its_own(tmp_path, split):
    file = write_cad(tmp_path / "cup.step", cup, ["casting"])
    box = ((-0.02, -0.02, -0.02), (0.06, 0.04, 0.02))
    mould = Mould(box=box, split=split, plug="plug")
    part = CadPart((CadFile(str(file), "casting"),), 0.03, across=1, growth=2.0, mould=mould)
    with gmsh_session():
        found = mesh_part(part, str(tmp_path / "a.msh"))
    bodies = {body.name: body.cad for body in found.bodies}
    assert set(bodies) == {"casting", "plug", *mould.bodies}
    assert bodies["plug"] == pytest.approx(30 * 10 * 15e-9, rel=1e-6)
    assert {m.name for m in found.interfaces if "plug" in m.name} == {"casting/plug"}
    (told,) = [remark for remark in found.remarks if "plug" in remark]
    assert told.startswith("1 piece of the mould, round (0.02, 0.01, 0.0125) m")
    assert told.endswith("hangs at no other part of it: the body 'plug'")


def test_no_solid_may_have_the_name_of_a_plug(tmp_path):
    file = write_cad(tmp_path / "cup.step", cup, ["casting"])
    mould = Mould(margin=0.02, plug="casting")
    part = CadPart((CadFile(str(file), "casting"),), 0.03, mould=mould)
    with gmsh_session(), pytest.raises(ValueError, match="a solid is called 'casting' like the bo"):
        mesh_part(part, str(tmp_path / "a.msh"))


@pytest.mark.parametrize(
    "mould, text",
    [
        (Mould(margin=0.01, cores=("sand",)), "mould.cores: no body 'sand'; there are: casting"),
        (Mould(margin=0.01, split=(2, 0.5)), "mould.split: the plane z = 0.5 m does not meet"),
        (
            Mould(
                margin=0.01, channels=(Channel("c", ((-1, 0.01, 0.01), (1, 0.01, 0.01)), 0.002),)
            ),
            r"the channel 'c' meets the body 'casting' round \(0.02, 0.01, 0.01\) m; move it",
        ),
        (Mould("casting", margin=0.01), "a solid is called 'casting' like the body that is made"),
        (
            Mould(margin=0.01, chills=(Chill("casting", ((0, 0, -0.01), (0.01, 0.01, 0))),)),
            "give one of them another name: geometry.names, or name under geometry.mould",
        ),
    ],
)
def test_refused(reported, mould, text):
    with pytest.raises(ValueError, match=text):
        reported(mould)


def test_a_plane_that_leaves_nothing_is_refused(reported):
    with pytest.raises(ValueError, match=r"symmetry: nothing of 'casting' lies in x > 0.5 m"):
        reported(None, symmetry=(SymmetryPlane(0, 0.5, True),))


def test_distances_to_a_bent_line():
    line = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0))
    points = np.array([[0.5, 0.0, 0.2], [-3.0, 4.0, 0.0], [1.0, 0.5, 0.0], [2.0, 2.0, 0.0]])
    assert distances_to_line(points, line) == pytest.approx([0.2, 5.0, 0.0, 2**0.5])
