"""A shell follows the solids: its volume and surface are those of a parallel body (Steiner)."""

from __future__ import annotations

from math import pi

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.cells import TETRAHEDRON, cell_qualities
from castx.meshes.cad.description import CadFile, CadPart, Mould, Selector, SymmetryPlane
from castx.meshes.cad.part import mesh_part
from castx.meshes.cad.shell import distances
from tests.cad_files import write_cad

pytestmark = pytest.mark.serial

SHELL = 6.0
SIDES = np.array([40.0, 20.0, 10.0])
AREA = 2.0 * (SIDES.prod() / SIDES).sum()
EDGES = 4.0 * SIDES.sum()
"""Of the bar [mm]."""


def parallel(distance):
    """Volume and surface of what lies within a distance of the bar, the bar left out [mm]."""
    ball = 4 / 3 * pi * distance**3
    volume = AREA * distance + EDGES * pi / 4 * distance**2 + ball
    return volume, AREA + EDGES * pi / 2 * distance + 3.0 * ball / distance


def bar(occ):
    return [occ.addBox(0, 0, 0, *SIDES)]


def cup(occ):
    """A bar of 40 x 40 x 30 with a pocket of 30 x 30 x 25 from above."""
    pocket = occ.addBox(5, 5, 5, 30, 30, 25)
    found, _ = occ.cut([(3, occ.addBox(0, 0, 0, 40, 40, 30))], [(3, pocket)])
    return [tag for _, tag in found]


@pytest.fixture(scope="module")
def meshed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shell")
    files = {make: write_cad(folder / f"{make.__name__}.step", make, ["casting"])
             for make in (bar, cup)}  # fmt: skip

    def mesh(mould, make=bar, *, size=0.01, across=1.0, growth=0.6, **changes):
        file = CadFile(str(files[make]), "casting")
        part = CadPart((file,), size, across=across, growth=growth, mould=mould, **changes)
        with gmsh_session():
            report = mesh_part(part, str(folder / "a.msh"))
            written = sum(len(gmsh.model.mesh.getElementsByType(TETRAHEDRON, tag)[0])
                          for _, tag in gmsh.model.getEntities(3))  # fmt: skip
            worst = cell_qualities([tag for _, tag in gmsh.model.getEntities(3)])[1].min()
        assert written == report.quality.cells and worst > 0.02
        return report, *(
            {m.name: m.mesh for m in kind}
            for kind in (report.bodies, report.interfaces, report.surfaces)
        )

    return mesh


def test_it_is_the_parallel_body_of_the_solid(meshed):
    volume, area = parallel(SHELL)
    off = []
    for across in (1, 3):
        report, bodies, interfaces, surfaces = meshed(Mould(shell=1e-3 * SHELL), across=across)
        off.append(1.0 - 1e9 * bodies["mould"] / volume)
        assert interfaces["casting/mould"] == pytest.approx(1e-6 * AREA, rel=1e-9)
        assert surfaces["mould/outside"] == pytest.approx(1e-6 * area, rel=0.06 / across)
        assert bodies["casting"] == pytest.approx(1e-9 * SIDES.prod(), rel=1e-9)
        low, high = (1e3 * np.array(corner) for corner in report.boxes["mould"])
        np.testing.assert_allclose(low, -SHELL, atol=0.1)
        np.testing.assert_allclose(high, SIDES + SHELL, atol=0.1)
    # Chords of its rounds lie inside them, by the square of the size.
    assert 0.0 < off[1] < 0.03 and off[1] < 0.4 * off[0]


def test_cad_and_mesh_agree_for_all_that_is_cut(meshed):
    report, *_ = meshed(Mould(shell=1e-3 * SHELL, split=(2, 0.004)))
    for measure in (*report.bodies, *report.interfaces, *report.surfaces):
        assert measure.mesh == pytest.approx(measure.cad, rel=1e-9)


def test_halves_planes_and_an_open_top_cut_it_through(meshed):
    """A quarter of the bar, open above, in two halves."""
    box = ((-0.01, -0.01, -0.01), (0.05, 0.03, 1e-3 * SIDES[2]))
    mould = Mould(shell=1e-3 * SHELL, box=box, split=(2, 0.004))
    planes = (SymmetryPlane(0, 0.02, True), SymmetryPlane(1, 0.01, True))
    found, bodies, interfaces, surfaces = meshed(mould, across=3, size=0.004, symmetry=planes)
    length, width, height = 20.0, 10.0, SIDES[2]
    corner = pi / 4 * SHELL**2
    beside = (length + width) * SHELL + corner  # of a section through the walls
    assert bodies["mould-high"] == pytest.approx(1e-9 * beside * (height - 4.0), rel=0.01)
    low = beside * 4.0 + length * width * SHELL + (length + width) * corner
    assert bodies["mould-low"] == pytest.approx(1e-9 * (low + pi / 6 * SHELL**3), rel=0.04)
    assert interfaces["mould-high/mould-low"] == pytest.approx(1e-6 * beside, rel=0.01)
    through = {name: area for name, area in surfaces.items() if "symmetry" in name}
    section = SHELL * (height + width) + corner
    assert through["mould-low/symmetry-x"] + through["mould-high/symmetry-x"] == pytest.approx(
        1e-6 * section, rel=0.01
    )
    assert found.boxes["mould-high"][1][2] == pytest.approx(1e-3 * height)


def test_the_plane_between_halves_stays_even(meshed):
    """It cuts the rounds above the bar, whose surface is oblique to it."""
    found, *_ = meshed(Mould(shell=1e-3 * SHELL, split=(2, 0.013)), across=3, size=0.004)
    assert found.boxes["mould-low"][1][2] == found.boxes["mould-high"][0][2] == 0.013


def test_a_pocket_is_lined_not_filled(meshed):
    _, bodies, _, _ = meshed(Mould(shell=0.004), cup, across=2)
    block = Mould(margin=0.005)
    full = meshed(block, cup)[1]["mould"]
    rim = 4 * 40 * 30 + 40 * 40  # outer walls and floor [mm²]
    lining = 4 * 30 * 25 + 30 * 30
    assert bodies["mould"] == pytest.approx(1e-9 * 4 * (rim + lining + 700), rel=0.1)
    assert bodies["mould"] < 0.7 * full


def test_a_plug_that_fills_its_pocket_has_no_outer_surface(meshed):
    """It lies within the shell everywhere, and ends at the open top."""
    box = ((-0.02, -0.02, -0.02), (0.06, 0.06, 0.03))
    _, bodies, _, surfaces = meshed(Mould(shell=0.016, box=box, plug="mould-plug"), cup)
    assert bodies["mould-plug"] == pytest.approx(30 * 30 * 25e-9, rel=1e-9)
    assert surfaces["mould-plug/outside"] == pytest.approx(30 * 30e-6, rel=1e-9)


def test_a_thicker_shell_has_more_layers_and_volume(meshed):
    cells = {}
    for shell in (3.0, SHELL):
        report, bodies, _, _ = meshed(Mould(shell=1e-3 * shell), across=2)
        assert bodies["mould"] == pytest.approx(1e-9 * parallel(shell)[0], rel=0.05)
        cells[shell] = report.quality.cells
    assert cells[3.0] > 1.3 * cells[SHELL]  # cells as large as half of a shell


def test_what_has_nothing_left_is_refused(meshed):
    below = Selector("below", body="mould", normal=(0.0, 0.0, -1.0))
    with pytest.raises(ValueError, match=r"nothing of mould/below is left .* is mould/outside"):
        meshed(Mould(shell=1e-3 * SHELL), selectors=(below,))
    with pytest.raises(ValueError, match=r"nothing of 'mould-low' lies within mould.shell, 0.006"):
        box = ((-0.01, -0.01, -0.02), (0.05, 0.03, 0.02))
        meshed(Mould(shell=1e-3 * SHELL, box=box, split=(2, -0.01)))


def test_distances_are_those_of_all_pairs():
    random = np.random.default_rng(2)
    points, others = 30.0 + random.uniform(size=(300, 3)), 30.0 + random.uniform(size=(200, 3))
    points[:20] += 5.0
    apart = np.linalg.norm(points[:, None] - others, axis=2).min(axis=1)
    for reach in (0.05, 0.2, 3.0):
        found = distances(points, others, reach)
        np.testing.assert_allclose(found, np.minimum(apart, reach), rtol=0, atol=1e-12)
