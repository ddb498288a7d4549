"""Sizes follow walls, curvature, interfaces and places, and grow away from them."""

from __future__ import annotations

import re
from dataclasses import replace

import gmsh
import numpy as np
import pytest

from castx.domain.gmsh_import import read_model
from castx.domain.source import gmsh_session
from castx.meshes.cad.assembly import join
from castx.meshes.cad.description import CadFile, CadPart, Selector, SizeRule
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.part import mesh_part
from castx.meshes.cad.reading import Solid
from castx.meshes.cad.sizes import (
    SizeGrid,
    estimated_cells,
    samples_of,
    size_grid,
    wall_thickness,
    wanted_sizes,
)
from tests.cad_files import write_cad

pytestmark = pytest.mark.serial

NAMES = ("casting", "mould")
PART = CadPart((CadFile("a.step"),), 0.02)


def plate_in_block(occ):
    """A plate of 60 x 40 x 4 in the middle of a block of 120 x 100 x 64."""
    plate = occ.addBox(0, 0, 0, 60, 40, 4)
    block = occ.addBox(-30, -30, -30, 120, 100, 64)
    ((_, mould),), _ = occ.cut([(3, block)], [(3, plate)], removeTool=False)
    return [plate, mould]


@pytest.fixture(scope="module")
def sampled():
    with gmsh_session():
        tags = plate_in_block(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        volumes = join([Solid(t, n, n) for t, n in zip(tags, NAMES, strict=True)], 0.0)
        faces = faces_of(volumes)
        gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 20)
        gmsh.model.mesh.generate(2)
        samples = samples_of(faces)
        yield faces, samples


def bored(block, bore, size, curvature):
    """Return faces and samples of a block less a cylinder, with triangles of a size at most."""
    with gmsh_session():
        occ = gmsh.model.occ
        whole, taken = occ.addBox(0, 0, 0, *block), occ.addCylinder(*bore)
        ((_, part),), _ = occ.cut([(3, whole)], [(3, taken)])
        occ.synchronize()
        faces = faces_of({part: "casting"})
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", curvature)
        gmsh.model.mesh.generate(2)
        return faces, samples_of(faces)


def test_coarse_triangles_of_a_bore_do_not_thin_the_wall_above_it():
    """Eight millimetres of wall are left at the crest, and no triangle reaches beyond its edges."""
    faces, samples = bored((100, 60, 40), (-1, 30, 20, 102, 0, 0, 12), 30, 5)
    walls, _ = wall_thickness(samples, faces, "casting")
    upper = np.array([face.normals[0, 2] > 0.99 for face in faces])[samples.faces]
    above = upper & (np.abs(samples.points[:, 1] - 0.03) < 0.01)
    assert above.any() and 0.008 - 1e-9 < walls[above].min() < 0.0105
    assert walls[upper].max() == pytest.approx(0.04)


def test_a_knife_edge_is_as_thick_as_where_its_triangles_end():
    """A corner left by a bore that touches both its sides; the middles of triangles are thinner."""
    faces, samples = bored((20, 40, 20), (20, -1, 20, 0, 42, 0, 20), 15, 12)
    walls, _ = wall_thickness(samples, faces, "casting")
    flat = np.array([abs(face.normals[0, 1]) < 1e-3 for face in faces])[samples.faces]
    round_ = np.array([face.radius is not None for face in faces])[samples.faces]
    heights = np.sort(samples.corners[round_][:, :, 2].ravel())
    first = heights[heights > 1e-6][0]  # of the bore above its side, beside the edge
    assert walls[flat | round_].min() > 0.7 * first


def test_a_triangle_at_the_edge_of_a_wedge_is_as_thick_as_at_its_corners_off_it():
    """One corner off the edge or the mean of two; without any on it as in its middle."""
    slope, angle = 0.2, np.arctan(0.2)
    with gmsh_session():
        occ = gmsh.model.occ
        corners = [occ.addPoint(*place, 0) for place in ((0, 0), (20, 0), (20, 20 * slope))]
        lines = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        section = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        wedge = next(tag for dim, tag in occ.extrude([(2, section)], 0, 0, 20) if dim == 3)
        occ.synchronize()
        faces = faces_of({wedge: "casting"})
        gmsh.option.setNumber("Mesh.MeshSizeMax", 5)
        gmsh.model.mesh.generate(2)
        samples = samples_of(faces)
        walls, _ = wall_thickness(samples, faces, "casting")
    lower = np.array([face.normals[0, 1] < -0.999 for face in faces])[samples.faces]
    depths = slope * samples.corners[lower][:, :, 0]
    off = (depths > 1e-9).sum(axis=1)
    assert {1, 2, 3} <= set(off.tolist()) and angle < np.pi / 6
    np.testing.assert_allclose(walls[lower], depths.sum(axis=1) / off, rtol=1e-6)


def test_walls_are_as_thick_as_drawn(sampled):
    faces, samples = sampled
    flat = np.array([abs(face.normals[0, 2]) > 0.5 and len(face.bodies) == 2 for face in faces])
    plate, inward = wall_thickness(samples, faces, "casting")
    assert plate[flat[samples.faces]] == pytest.approx(0.004, rel=1e-9)
    heights = samples.points[flat[samples.faces], 2] - 0.002
    assert (inward[flat[samples.faces], 2] * heights < 0).all()
    free = np.array([len(face.bodies) == 1 for face in faces])[samples.faces]
    assert np.isinf(plate[free]).all()
    mould, _ = wall_thickness(samples, faces, "mould")
    assert mould.min() == pytest.approx(0.03, rel=1e-9)


def test_each_place_gets_the_least_of_its_sizes(sampled):
    faces, samples = sampled
    shared = np.array([len(face.bodies) == 2 for face in faces])[samples.faces]
    count = len(shared)
    wishes = wanted_sizes(PART, faces, {}, samples)
    middles = wishes.corners[count:].mean(axis=1)
    thin = middles[wishes.sizes[count:] < 0.0021]
    assert len(thin) and thin[:, 2] == pytest.approx(0.002)  # of the plate
    sizes = wishes.sizes[:count]
    assert sizes.min() == pytest.approx(0.002) and sizes.max() == pytest.approx(0.02)
    across = wanted_sizes(replace(PART, across=4), faces, {}, samples).sizes
    assert across.min() == pytest.approx(0.001)
    fine = wanted_sizes(replace(PART, interface_size=0.0015), faces, {}, samples).sizes
    fine = fine[:count]
    assert fine[shared] == pytest.approx(0.0015)
    assert (fine[~shared] == sizes[~shared]).all()
    (top,) = [f for f in faces if len(f.bodies) == 1 and f.normals[0, 2] > 0.5]
    here = samples.faces == faces.index(top)
    rules = (SizeRule(0.001, surface="top"), SizeRule(0.003, body="casting"))
    ruled = wanted_sizes(replace(PART, rules=rules), faces, {"top": [top]}, samples).sizes[:count]
    assert ruled[here] == pytest.approx(0.001) and ruled[shared].max() == pytest.approx(0.003)


def test_sizes_grow_with_the_distance(sampled):
    faces, samples = sampled
    box = ((0.0, 0.0, 0.02), (0.01, 0.01, 0.03))
    part = replace(PART, rules=(SizeRule(0.001, within=box),))
    grid = size_grid(part, wanted_sizes(part, faces, {}, samples))
    axes = [
        low + grid.step * np.arange(n) for low, n in zip(grid.lowest, grid.sizes.shape, strict=True)
    ]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    boxed = (x > 0) & (x < 0.01) & (y > 0) & (y < 0.01) & (z > 0.02) & (z < 0.03)
    assert boxed.any() and (grid.sizes[boxed] == 0.001).all()
    below = (np.abs(x - 0.03) < 0.005) & (np.abs(y - 0.02) < 0.005) & (z < 0.0)
    expected = np.minimum(0.002 - 0.4 * z[below], 0.02)
    assert grid.sizes[below] == pytest.approx(expected, abs=0.8 * grid.step)
    slopes = np.abs(np.diff(grid.sizes, axis=0))
    assert slopes.max() <= 0.4 * grid.step * (1 + 1e-9)


def test_the_grid_is_written_in_millimetres(tmp_path):
    numbers = np.arange(24.0).reshape(2, 3, 4) + 1.0
    SizeGrid(np.array([0.0, 0.0, 0.0]), 0.01, numbers / 1e3).write(str(tmp_path / "grid"))
    data = np.fromfile(tmp_path / "grid", dtype=np.float64, count=6)
    assert data == pytest.approx([0, 0, 0, 10, 10, 10])
    counts = np.fromfile(tmp_path / "grid", dtype=np.int32, offset=48, count=3)
    values = np.fromfile(tmp_path / "grid", dtype=np.float64, offset=60)
    assert counts.tolist() == [2, 3, 4] and values == pytest.approx(numbers.ravel())


@pytest.fixture(scope="module")
def mesh_of(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plate")
    path = write_cad(folder / "plate.step", plate_in_block, NAMES)

    def mesh(**changes):
        part = replace(PART, files=(CadFile(str(path)),), **changes)
        with gmsh_session():
            mesh_part(part, str(folder / "a.msh"))
        with gmsh_session():
            gmsh.merge(str(folder / "a.msh"))
            return read_model(NAMES, 3, "plate")

    return mesh


def lengths(mesh, body, where=None):
    """Mean lengths of the edges of the cells of a body, in a region of their middles."""
    corners = mesh.points[mesh.cells[mesh.bodies == NAMES.index(body)]]
    first, second = np.triu_indices(4, 1)
    edges = np.linalg.norm(corners[:, first] - corners[:, second], axis=2).mean(axis=1)
    return edges if where is None else edges[where(corners.mean(axis=1))]


def test_a_plate_has_so_many_cells_across(mesh_of):
    one, three = mesh_of(across=1), mesh_of(across=3)
    assert np.median(lengths(one, "casting")) == pytest.approx(0.004, rel=0.4)
    assert np.median(lengths(three, "casting")) == pytest.approx(0.004 / 3, rel=0.4)
    inside = three.points[(three.points[:, 2] > 1e-6) & (three.points[:, 2] < 0.004 - 1e-6)]
    middle = np.abs(inside[:, :2] - [0.03, 0.02]).max(axis=1) < 0.015
    assert middle.sum() > 100  # nodes in two layers between the sides
    far = lengths(three, "mould", lambda x: x[:, 2] > 0.024)
    assert np.median(far) > 2.0 * np.median(lengths(three, "casting"))


def test_cells_across_need_be_no_whole_number(mesh_of):
    mesh = mesh_of(across=1.5)
    assert np.median(lengths(mesh, "casting")) == pytest.approx(0.004 / 1.5, rel=0.4)


def test_a_box_and_a_surface_are_finer(mesh_of):
    corner = ((-0.03, -0.03, -0.03), (0.0, 0.0, 0.0))
    rules = (SizeRule(0.003, within=corner), SizeRule(0.003, surface="top"))
    selector = Selector("top", normal=(0.0, 0.0, 1.0), angle=0.01)
    mesh = mesh_of(across=1, rules=rules, selectors=(selector,), growth=1.0)
    boxed = lengths(mesh, "mould", lambda x: (x < -0.003).all(axis=1))
    assert np.median(boxed) == pytest.approx(0.003, rel=0.4)
    top = lengths(mesh, "mould", lambda x: x[:, 2] > 0.0335)
    assert np.median(top) == pytest.approx(0.003, rel=0.4)
    assert lengths(mesh, "mould", lambda x: (x[:, 2] < -0.02) & (x[:, 0] > 0.06)).mean() > 0.007


def test_the_number_of_cells_is_estimated_and_bounded(mesh_of, sampled):
    faces, samples = sampled
    volumes = {"casting": 9.6e-6, "mould": 758.4e-6}
    for changes in ({"across": 1}, {"across": 2}, {"across": 1, "size": 0.008}):
        part = replace(PART, **changes)
        sizes = wanted_sizes(part, faces, {}, samples).sizes[: len(samples.areas)]
        expected = estimated_cells(part, samples, sizes, volumes)
        assert 0.5 < expected / len(mesh_of(**changes).cells) < 2.0
    text = r"about (\S*) cells, and geometry.most_cells allows 1.0e\+03; .* sizes (\S*) times"
    with pytest.raises(ValueError, match=text) as refused:
        mesh_of(most_cells=1e3)
    found = re.search(text, str(refused.value))
    assert found is not None
    cells, factor = map(float, found.groups())
    assert 1.0 < factor**3 / (cells / 1e3) < 1.5  # cells by the cube of their size, and some room
