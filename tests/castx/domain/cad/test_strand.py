"""A strand is found by its faces, and its slice meshed, in a quarter where that is enough."""

from __future__ import annotations

import math
import tomllib

import numpy as np
import pytest

from castx.case.reading.read import load_case, read_case
from castx.domain.cad.new_case import Wanted, write_new_case
from castx.domain.cad.strand import new_slice, strand_of
from castx.domain.source import named_mesh
from castx.errors import CaseError
from castx.process.simulation import Simulation
from tests.cad_files import two_blocks, write_cad

pytestmark = pytest.mark.serial


def billet(occ, width=60.0, depth=40.0, turned=False):
    """A bar of 100 mm with round edges along it."""
    face = occ.addRectangle(0, 0, 0, width, depth, roundedRadius=6)
    if turned:
        occ.rotate([(2, face)], 0, 0, 0, 0, 1, 0, math.pi / 2)
    along = (100, 0, 0) if turned else (0, 0, 100)
    return [tag for dim, tag in occ.extrude([(2, face)], *along) if dim == 3]


def angle(occ):
    """A bar whose section is an L."""
    whole, out = occ.addBox(0, 0, 0, 40, 40, 100), occ.addBox(15, 15, 0, 40, 40, 100)
    ((_, part),), _ = occ.cut([(3, whole)], [(3, out)])
    return [part]


def pipe(occ):
    outer, inner = (occ.addCylinder(0, 0, 0, 0, 0, 100, radius) for radius in (30, 15))
    ((_, part),), _ = occ.cut([(3, outer)], [(3, inner)])
    return [part]


@pytest.mark.parametrize("turned, axis", [(False, 2), (True, 0)])
def test_the_axis_of_a_prism_is_the_direction_of_casting(tmp_path, turned, axis):
    path = write_cad(tmp_path / "b.step", lambda occ: billet(occ, turned=turned))
    prism = strand_of(path)
    section = prism.section
    corners = 4 * 36 - math.pi * 36
    assert section.axis == axis and prism.others == ()
    assert section.area == pytest.approx(1e-6 * (2400 - corners), rel=1e-6)
    assert section.perimeter == pytest.approx(1e-3 * (200 - 48 + 12 * math.pi), rel=1e-6)
    assert sorted(section.extents) == pytest.approx([0.04, 0.06])
    assert (section.thickness, section.width) == pytest.approx((0.04, 0.06))


def test_a_bar_with_sharp_edges_runs_along_its_longest_extent_as_is_told(tmp_path):
    path = write_cad(tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 40, 120, 40)])
    said = []
    cut = new_slice(path, tmp_path / "a.toml", 0.012, said.append)
    assert cut.section.axis == 1 and strand_of(path).others == (0, 2)
    assert any("might along x, z too: round the edges" in line for line in said)


def test_a_slice_of_a_billet_is_a_quarter_one_cell_thick(tmp_path):
    path = write_cad(tmp_path / "b.step", billet)
    cut = new_slice(path, tmp_path / "a.toml", 0.012, lambda _: None)
    assert cut.quarter and (cut.strand, cut.mould) == ("b", "mould")
    assert cut.planes == ((2, 0.00067, False), (0, 0.03, True), (1, 0.02, True))
    volumes = dict(cut.case.bodies)
    assert volumes["b"] == pytest.approx(0.25 * 0.00067 * cut.section.area, rel=1e-6)
    assert cut.block == ((-0.012, -0.012, 0.0), (0.072, 0.052, 0.1))
    corner = 6e-3 * (1.0 - math.sqrt(0.5))  # from the sharp one, along each side
    assert cut.places["core"] == pytest.approx((0.03, 0.02, 0.000335))
    assert cut.places["face-x"] == pytest.approx((0.06, 0.02, 0.000335))
    assert cut.places["face-y"] == pytest.approx((0.03, 0.04, 0.000335))
    assert cut.places["edge"] == pytest.approx((0.06 - corner, 0.04 - corner, 0.000335), abs=1e-4)
    assert {name for name, _ in cut.case.surfaces} == {
        "b/cut", "b/symmetry-x", "b/symmetry-y", "b/symmetry-z", "mould/cut", "mould/outside",
        "mould/symmetry-x", "mould/symmetry-y", "mould/symmetry-z",
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("shape, quarter", [(billet, True), (angle, False)])
def test_the_case_of_a_strand_is_meshed_one_cell_thick(tmp_path, shape, quarter):
    path, said = write_cad(tmp_path / "b.step", shape), []
    write_new_case(path, tmp_path / "b.toml", Wanted("continuous"), said.append)
    case = load_case(tmp_path / "b.toml")
    mesh = named_mesh(case.geometry, [body.name for body in case.bodies])
    heights = sorted(set(mesh.points[:, 2].round(6)))
    between = [z for z in heights if heights[0] < z < heights[-1]]
    inside = sum(int((abs(mesh.points[:, 2] - z) < 1e-6).sum()) for z in between)
    assert inside < 0.1 * len(mesh.points)  # nine of ten nodes lie on the cuts
    assert len(case.geometry.cad.symmetry) == (3 if quarter else 1)
    assert any(line.startswith("its quarters are not alike") for line in said) != quarter


@pytest.mark.slow
def test_a_slab_below_its_mould_moves_by_what_it_contracts(comm, tmp_path):
    """Without rolls its wide face bulged by 0.8 mm in 30 s, and by 12 mm at 150 mm × 600 mm.

    Its edges, the coldest of it, shorten its walls by α (T_s − T), after the taper has pressed them
    inwards while they were soft.
    """
    path = write_cad(tmp_path / "s.step", lambda occ: billet(occ, 240.0, 40.0))
    write_new_case(path, tmp_path / "s.toml", Wanted("continuous"))
    data = tomllib.loads((tmp_path / "s.toml").read_text())
    data["geometry"] |= {"size": "10 mm", "interface_size": "4 mm"}
    data["geometry"]["symmetry"][0] = "z < 4 mm"
    data |= {"stages": data["stages"][:2], "probes": [], "output": {}}
    data["time"] = {"end": "24 s", "fixed_step": 1.0}
    run = Simulation.from_case(read_case(data, tmp_path / "s.toml"), comm)
    for _ in run:
        pass
    strand = run.problem.mechanics.bodies["s"]
    points, temperature = strand.mesh.points, run.problem.heat.temperature["s"].x.array
    moved = strand.solution.x.array.reshape(len(points), -1)
    for axis, wide in ((1, True), (0, False)):
        face = points[:, axis] > points[:, axis].max() - 1e-6
        half, along = np.ptp(points[:, axis]), moved[face, axis]
        moves = (20e-6 * (1400.0 - temperature.min()) + 0.009 * 0.7) * half
        assert -moves < along.min() and along.max() < 0.0
        assert np.ptp(along) < (1e-9 if wide else moves)
    run.destroy()


@pytest.mark.parametrize(
    "shape, names, text",
    [
        (two_blocks, ["casting", "die"], "has the bodies casting, die; a strand is one solid"),
        (lambda occ: [occ.addSphere(0, 0, 0, 20)], [], "is no prism along x, y or z; .* extruded"),
        (pipe, [], "the section is hollow, .*; give the section without its hole"),
    ],
)
def test_what_is_no_strand_is_refused(tmp_path, shape, names, text):
    path = write_cad(tmp_path / "a.step", shape, names)
    with pytest.raises(CaseError, match=text):
        new_slice(path, tmp_path / "a.toml", 0.012, lambda _: None)


def test_an_alloy_that_no_mould_of_strands_is_known_for_is_refused(tmp_path):
    path = write_cad(tmp_path / "b.step", billet)
    with pytest.raises(CaseError, match="no heat transfer between aluminium"):
        write_new_case(path, tmp_path / "a.toml", Wanted("continuous", "AlSi7Mg"))
