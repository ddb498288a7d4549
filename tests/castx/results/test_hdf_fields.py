"""One file a body on any number of ranks: what the pieces of VTU hold, point by point."""

import h5py
import numpy as np
import pytest

from castx.errors import StorageError
from castx.foundry.front.solidification import Solidification
from castx.results.field_copies import FieldCopies
from castx.results.fields import Fields
from castx.results.files.body_series import BodySeries
from castx.results.files.collection import PieceSeries
from castx.results.files.disk import Disk
from castx.results.files.vtu import Piece
from castx.results.hdf_fields import HdfFields
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh
from tests.castx.results.files.test_vtkhdf import read_by_vtk

NAMES = ("temperature", "displacement", "stress", "von_mises", "gap")
TIMES = (0.0, 0.4, 1.1, 2.0)


def formulas(time):
    return {
        "temperature": lambda x: 300.0 + 1000.0 * x[:, 0] + time,
        "displacement": lambda x: 1e-3 * x * time,
        "stress": lambda x: np.arange(6.0) + 1e3 * x[:, :1] + time,
        "von_mises": lambda x: x[:, 0] - 2.0 * x[:, 1] + time,
        "gap": lambda x: x[:, -1],
    }


def written(comm, folder, form, model="axisymmetric", cells="simplices"):
    mesh = cylinder_mesh(comm, model, 6e-3, cells)
    pairs = casting_pairs(mesh)
    folder.mkdir(exist_ok=True)
    comm.Barrier()
    fields = Fields(
        folder, NAMES, 1.0, mesh, Solidification(mesh, {}), Disk(comm), form=form
    )
    for step, time in enumerate(TIMES):
        fields.update(FakeSnapshot(time, step, mesh, pairs, formulas(time)))
    comm.Barrier()
    return folder


def by_place(points, values):
    """Return values in the order of their places, which are those of a mesh."""
    return values[np.lexsort(np.round(points, 9).T)]


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_both_formats_hold_the_same(comm, shared_tmp_path, model, cells):
    hdf = BodySeries(written(comm, shared_tmp_path / "hdf", "vtkhdf", model, cells))
    vtu = PieceSeries(written(comm, shared_tmp_path / "vtu", "vtu", model, cells))
    assert hdf.times == vtu.times == [0.0, 1.0, 2.0]
    for time in hdf.times:
        found, expected = hdf.read(time), vtu.read(time)
        assert list(found) == list(expected) == ["casting", "mould"]
        for name, grid in found.items():
            other = expected[name]
            assert grid.n_points == other.n_points and grid.n_cells == other.n_cells
            assert set(grid.array_names) == set(other.array_names) - {"name"}
            for key in other.point_data:
                mine = by_place(grid.points, grid.point_data[key])
                np.testing.assert_allclose(mine, by_place(other.points, other[key]), atol=1e-12)
            centres, others = grid.cell_centers().points, other.cell_centers().points
            for key in other.cell_data:
                mine = by_place(centres, grid.cell_data[key])
                np.testing.assert_allclose(mine, by_place(others, other[key]), atol=1e-12)


@pytest.mark.ranks
def test_vtk_reads_what_several_ranks_have_written(comm, shared_tmp_path):
    folder = written(comm, shared_tmp_path, "vtkhdf")
    times, meshes = read_by_vtk(folder / "casting.hdf")
    assert times == [0.0, 1.0, 2.0]
    for time, grid in zip(times, meshes, strict=True):
        r, z = grid.points[:, 0], grid.points[:, 1]
        np.testing.assert_allclose(grid["temperature"], 300.0 + 1000.0 * r + time)
        np.testing.assert_allclose(grid["gap"], np.where(np.isclose(r, 0.02), z, 0.0), atol=1e-15)
        centres = grid.cell_centers().points
        np.testing.assert_allclose(grid["von_mises"], centres[:, 0] - 2 * centres[:, 1] + time)
        np.testing.assert_allclose(grid["stress"][:, 4], 5.0 + 1e3 * centres[:, 0] + time)
    assert meshes[0].n_points == len(np.unique(meshes[0].points, axis=0))


@pytest.mark.ranks
def test_moments_go_on_behind_those_that_are_kept(comm, shared_tmp_path):
    """A body that came only after the kept ones has no file any more."""
    mesh = cylinder_mesh(comm, size=1e-2)
    pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}

    def files():
        return HdfFields(shared_tmp_path, mesh, pieces, {}, Disk(comm))

    def state(time, *names):
        nodal = {name: {"temperature": time + pieces[name].points[:, 0]} for name in names}
        return FieldCopies(time, (1, 0), nodal, {name: {} for name in names})

    first = files()
    assert first.last is None
    for time in (0.0, 1.0):
        first.write(state(time, "casting"))
    first.write(state(2.0, "casting", "mould"))
    assert first.last == 2.0
    notes = first.notes()
    assert notes[2] == {"time": 2.0, "bodies": ["casting", "mould"]}
    again = files()
    again.resume(notes[:2])
    comm.Barrier()
    assert again.last == 1.0 and not (shared_tmp_path / "mould.hdf").exists()
    comm.Barrier()
    again.write(state(1.5, "casting"))
    comm.Barrier()
    series = BodySeries(shared_tmp_path)
    assert series.times == [0.0, 1.0, 1.5]
    for time in series.times:
        grid = series.read(time)["casting"]
        np.testing.assert_allclose(grid["temperature"], time + grid.points[:, 0])


def test_fields_have_their_units(comm, shared_tmp_path):
    folder = written(comm, shared_tmp_path, "vtkhdf")
    with h5py.File(folder / "mould.hdf") as file:
        root = file["VTKHDF"]
        assert root["CellData/stress"].attrs["units"] == "Pa"
        assert root["PointData/temperature"].attrs["units"] == "°C"


@pytest.mark.ranks
def test_a_lost_folder_is_a_failure_on_all_ranks(comm, shared_tmp_path):
    mesh = cylinder_mesh(comm, size=1e-2)
    pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}
    files = HdfFields(shared_tmp_path / "none", mesh, pieces, {}, Disk(comm))
    nodal = {"casting": {"temperature": pieces["casting"].points[:, 0]}}
    with pytest.raises(StorageError, match="none"):
        files.write(FieldCopies(0.0, (1, 0), nodal, {"casting": {}}))
