"""Pieces and their collection: each body, rank and moment once, in the order of time."""

import numpy as np
import pytest
import pyvista

from castx.errors import StorageError
from castx.results.field_copies import FieldCopies
from castx.results.files.disk import Disk
from castx.results.files.vtu import Piece
from castx.results.vtu_fields import VtuFields, WrittenMoment, collection, piece_name, pieces_of
from tests.castx.fakes import cylinder_mesh

MOMENTS = [WrittenMoment(0.0, {"a": [0, 2], "b": [1]}), WrittenMoment(0.1, {"b": [1]})]


def files(comm, folder):
    mesh = cylinder_mesh(comm, size=1e-2)
    pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}
    return VtuFields(folder, comm, pieces, {"temperature": "°C"}, Disk(comm)), pieces


def state(pieces, time):
    nodal = {name: {"temperature": time + piece.points[:, 0]} for name, piece in pieces.items()}
    return FieldCopies(time, (1, 0), nodal, {name: {} for name in pieces})


@pytest.mark.serial
def test_pieces_are_named_by_body_moment_and_rank():
    assert piece_name("casting", 12, 3) == "casting_00012_3.vtu"
    names = [name for _, _, name in pieces_of(MOMENTS)]
    assert names == ["a_00000_0.vtu", "a_00000_2.vtu", "b_00000_1.vtu", "b_00001_1.vtu"]


@pytest.mark.serial
def test_parts_are_counted_anew_at_each_moment():
    lines = collection(MOMENTS).splitlines()[2:-2]
    assert [line.split('part="')[1][0] for line in lines] == ["0", "1", "2", "0"]
    assert 'timestep="0.1" group="b"' in lines[3]


@pytest.mark.ranks
def test_moments_are_appended_and_taken_back(comm, shared_tmp_path):
    written, pieces = files(comm, shared_tmp_path)
    assert written.last is None
    for time in (0.0, 2.0):
        written.write(state(pieces, time))
    comm.Barrier()
    assert written.last == 2.0
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    assert reader.time_values == [0.0, 2.0]
    reader.set_active_time_value(2.0)
    for block in reader.read():
        np.testing.assert_allclose(block["temperature"], 2.0 + block.points[:, 0])
    comm.Barrier()
    written.resume(written.notes()[:1])
    comm.Barrier()
    assert written.last == 0.0
    assert not list(shared_tmp_path.glob("*_00001_*"))


@pytest.mark.ranks
def test_a_lost_folder_is_a_failure_on_all_ranks(comm, shared_tmp_path):
    written, pieces = files(comm, shared_tmp_path / "none")
    with pytest.raises(StorageError, match="none"):
        written.write(state(pieces, 0.0))
