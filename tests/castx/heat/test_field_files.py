"""Temperature fields out of files: formats, kinds of cells, units, places outside, refusals."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import dolfinx
import meshio
import numpy as np
import pytest
import pyvista
from dolfinx import fem, io

from castx.case.initial_temperature import FieldFile
from castx.errors import CaseError
from castx.heat.field_files import temperatures_at

pytestmark = pytest.mark.serial

CORNER = np.array([0.1, 0.2, 0.3])


def field(points):
    """Return a field that linear and multilinear cells reproduce, in °C."""
    points = np.asarray(points)
    return 500.0 + points @ np.array([1000.0, -500.0, 250.0])[: points.shape[1]]


def block(dimension: int, kind: str) -> pyvista.UnstructuredGrid:
    """Return a box of 0.06 × 0.05 × 0.04 m (a rectangle in the plane) with the field "T"."""
    cells = np.array([6, 5, 4 if dimension == 3 else 0])
    grid = pyvista.ImageData(dimensions=cells + 1, spacing=(0.01,) * 3, origin=CORNER)
    grid = grid.cast_to_unstructured_grid()
    if kind == "simplices":
        grid = grid.triangulate()
    grid["T"] = field(grid.points)
    return grid


def points(dimension: int, count: int = 50) -> np.ndarray:
    """Return points inside the block."""
    size = np.array([0.06, 0.05, 0.04])[:dimension]
    return CORNER[:dimension] + size * np.random.default_rng(3).uniform(size=(count, dimension))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kind", ["simplices", "boxes"])
def test_vtu(tmp_path, dimension, kind):
    grid = block(dimension, kind)
    grid.save(tmp_path / "a.vtu")
    places = points(dimension)
    expected = field(np.column_stack([places, np.full(len(places), 0.3)])[:, :3])
    found = temperatures_at(FieldFile(tmp_path / "a.vtu", "T"), places)
    np.testing.assert_allclose(found, expected, atol=1e-3)  # stored in single precision


def test_plane_of_another_orientation(tmp_path):
    grid = block(2, "simplices")
    grid.points = grid.points[:, [0, 2, 1]]  # in the plane of x and z
    grid.save(tmp_path / "a.vtu")
    places = points(2)
    expected = field(np.column_stack([places, np.full(len(places), 0.3)]))
    found = temperatures_at(FieldFile(tmp_path / "a.vtu", "T"), places)
    np.testing.assert_allclose(found, expected, atol=1e-3)


@pytest.mark.parametrize("encoding", ["HDF5", "ASCII"])
def test_xdmf_of_dolfinx_gives_the_last_moment(tmp_path, encoding):
    mesh = dolfinx.mesh.create_box(MPI.COMM_SELF, [CORNER, CORNER + 0.04], (3, 3, 3))
    function = fem.Function(fem.functionspace(mesh, ("Lagrange", 1)), name="T")
    file = tmp_path / "filling.xdmf"
    with io.XDMFFile(MPI.COMM_SELF, str(file), "w",
                     encoding=getattr(io.XDMFFile.Encoding, encoding)) as output:  # fmt: skip
        output.write_mesh(mesh)
        for time in (0.0, 2.0):
            function.interpolate(lambda x, time=time: field(x.T) + 50.0 * time)
            output.write_function(function, time)
    places = CORNER + 0.04 * np.random.default_rng(3).uniform(size=(30, 3))
    found = temperatures_at(FieldFile(file, "T"), places)
    np.testing.assert_allclose(found, field(places) + 100.0, atol=1e-3)


def test_xdmf_without_a_series(tmp_path):
    grid = block(2, "simplices")
    triangles = grid.cells.reshape(-1, 4)[:, 1:]
    mesh = meshio.Mesh(grid.points, [("triangle", triangles)], {"T": field(grid.points)})
    mesh.write(tmp_path / "a.xdmf")
    places = points(2)
    expected = field(np.column_stack([places, np.full(len(places), 0.3)]))
    found = temperatures_at(FieldFile(tmp_path / "a.xdmf", "T"), places)
    np.testing.assert_allclose(found, expected, atol=1e-3)


@pytest.mark.parametrize("unit, expected", [("degC", 500.0), ("K", 226.85), ("degF", 260.0)])
def test_units(tmp_path, unit, expected):
    grid = block(2, "boxes")
    grid["T"] = np.full(grid.n_points, 500.0)
    grid.save(tmp_path / "a.vtu")
    found = temperatures_at(FieldFile(tmp_path / "a.vtu", "T", unit), points(2))
    assert found == pytest.approx(expected)


def test_values_of_cells_are_averaged_to_the_points(tmp_path):
    grid = block(2, "boxes")
    grid.clear_data()
    grid.cell_data["T"] = field(grid.cell_centers().points)
    grid.save(tmp_path / "a.vtu")
    places = points(2)
    inside = (np.abs(places - CORNER[:2] - [0.03, 0.025]) < [0.02, 0.015]).all(axis=1)
    found = temperatures_at(FieldFile(tmp_path / "a.vtu", "T"), places[inside])
    expected = field(np.column_stack([places[inside], np.full(inside.sum(), 0.3)]))
    assert inside.sum() > 10
    np.testing.assert_allclose(found, expected, atol=1e-2)


def test_only_cells_of_the_model_count(tmp_path):
    """Faces with a field of their own, as gmsh and others write them beside the volume."""
    volume, face = block(3, "simplices"), block(2, "simplices")
    face["T"] = np.full(face.n_points, 1e4)
    both = volume.merge(face, merge_points=False)
    both.save(tmp_path / "a.vtu")
    places = points(3)
    found = temperatures_at(FieldFile(tmp_path / "a.vtu", "T"), places)
    np.testing.assert_allclose(found, field(places), atol=1e-3)


def test_points_just_outside_take_the_nearest_temperature(tmp_path):
    block(2, "simplices").save(tmp_path / "a.vtu")
    file = FieldFile(tmp_path / "a.vtu", "T")
    outside = CORNER[:2] + np.array([[0.03, -0.008], [-0.005, -0.005]])
    nearest = np.column_stack([np.maximum(outside, CORNER[:2]), [0.3, 0.3]])
    np.testing.assert_allclose(temperatures_at(file, outside), field(nearest), atol=1e-3)
    with pytest.raises(CaseError, match=r"ends 0.02 m short of \(0.13, 0.18\) m.*; 1 of 3 nodes"):
        temperatures_at(file, np.vstack([outside, CORNER[:2] + np.array([0.03, -0.02])]))


def test_refused(tmp_path):
    def found(name: str, field: str = "T", unit: str = "degC", dimension: int = 2):
        return temperatures_at(FieldFile(tmp_path / name, field, unit), points(dimension))

    grid = block(2, "simplices")
    grid["v"] = np.zeros((grid.n_points, 3))
    grid["bad"] = np.full(grid.n_points, np.nan)
    grid.save(tmp_path / "a.vtu")
    (tmp_path / "broken.vtu").write_text("<VTKFile")
    (tmp_path / "broken.xdmf").write_text("not xml")
    for arguments, text in [
        (("b.vtu",), "there is no file"),
        (("a.vtu", "Tmp"), "no field 'Tmp'; it has: T, v, bad"),
        (("a.vtu", "v"), "the field 'v' is no scalar, it has 3 parts"),
        (("a.vtu", "bad"), "holds numbers that are not finite"),
        (("a.vtu", "T", "degC", 3), "needs cells that are tetrahedra"),
        (("broken.vtu",), "broken.vtu"),
        (("broken.xdmf",), "broken.xdmf cannot be read"),
    ]:
        with pytest.raises(CaseError, match=text):
            found(*arguments)
    cold = block(2, "simplices")
    cold["T"] = np.full(cold.n_points, -300.0)
    cold.save(tmp_path / "cold.vtu")
    with pytest.raises(CaseError, match="the field 'T' goes below absolute zero"):
        found("cold.vtu")


def test_unreadable_file_is_refused(tmp_path):
    (tmp_path / "a.vtu").mkdir()
    with pytest.raises(CaseError, match="there is no file"):
        temperatures_at(FieldFile(Path(tmp_path / "a.vtu"), "T"), points(2))
