"""The written fields are what pyvista reads: every cell once, exact values, whole collections."""

import numpy as np
import pytest
import pyvista

from castx.case.output import FIELDS
from castx.foundry.front.solidification import Solidification
from castx.results.fields import Fields
from castx.results.files.disk import Disk
from castx.results.states.quantities import UNITS
from castx.results.states.snapshot import ProcessState
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh

NAMES = ("temperature", "displacement", "stress", "von_mises", "gap", "niyama")
FORMULAS = {
    "temperature": lambda x: 300.0 + 1000.0 * x[:, 0],
    "displacement": lambda x: 1e-3 * x,
    "stress": lambda x: np.tile(np.arange(6.0), (len(x), 1)),
    "von_mises": lambda x: x[:, 0],
    "gap": lambda x: x[:, -1],
}


def write(comm, folder, times, every, model="axisymmetric", cells="simplices"):
    mesh = cylinder_mesh(comm, model, 5e-3, cells)
    pairs = casting_pairs(mesh)
    fields = Fields(folder, NAMES, every, mesh, Solidification(mesh, {}), Disk(comm), form="vtu")
    for step, time in enumerate(times):
        fields.update(FakeSnapshot(time, step, mesh, pairs, FORMULAS))
    fields.write_pending()
    comm.Barrier()
    return mesh


def pieces(reader, time, body):
    reader.set_active_time_value(time)
    blocks = reader.read()
    known = [dataset.group for dataset in reader.active_datasets]
    return [block for block, group in zip(blocks, known, strict=True) if group == body]


KINDS = {
    ("axisymmetric", "simplices"): pyvista.CellType.TRIANGLE,
    ("axisymmetric", "quadrilaterals"): pyvista.CellType.QUAD,
    ("3d", "simplices"): pyvista.CellType.TETRA,
    ("3d", "quadrilaterals"): pyvista.CellType.HEXAHEDRON,
}


@pytest.mark.parametrize("model, cells", KINDS)
def test_pyvista_reads_every_owned_cell_once(comm, shared_tmp_path, model, cells):
    mesh = write(comm, shared_tmp_path, [0.0, 1.0], 1.0, model, cells)
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    for number, (name, body) in enumerate(mesh.bodies.items()):
        count = body.mesh.topology.index_map(body.mesh.topology.dim).size_global
        blocks = pieces(reader, 1.0, name)
        assert sum(block.n_cells for block in blocks) == count
        assert all((block.celltypes == KINDS[model, cells]).all() for block in blocks)
        assert all((block["body"] == number).all() for block in blocks)
    size = sum(
        block.compute_cell_sizes()["Volume" if model == "3d" else "Area"].sum()
        for block in pieces(reader, 1.0, "casting")
    )
    exact = np.pi * 0.02**2 / 4 * 0.04 if model == "3d" else 0.02 * 0.04
    assert size == pytest.approx(exact, rel=0.05)


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_pieces_of_all_ranks_share_their_points(comm, shared_tmp_path, model, cells):
    mesh = write(comm, shared_tmp_path, [0.0], None, model, cells)
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    for name, body in mesh.bodies.items():
        points = np.concatenate([block.points for block in pieces(reader, 0.0, name)])
        assert len(np.unique(points, axis=0)) == body.nodes.dofmap.index_map.size_global


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_values_are_those_of_the_snapshot(cells, comm, shared_tmp_path):
    write(comm, shared_tmp_path, [0.0], None, cells=cells)
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    for block in pieces(reader, 0.0, "casting"):
        r, z = block.points[:, 0], block.points[:, 1]
        np.testing.assert_allclose(block["temperature"], 300.0 + 1000.0 * r)
        np.testing.assert_allclose(block["displacement"], 1e-3 * block.points, atol=1e-18)
        np.testing.assert_allclose(block["von_mises"], block.cell_centers().points[:, 0])
        np.testing.assert_array_equal(block["stress"][0], [0.0, 1.0, 2.0, 3.0, 5.0, 4.0])
        np.testing.assert_allclose(block["gap"], np.where(np.isclose(r, 0.02), z, 0.0), atol=1e-15)
        assert np.isnan(block["niyama"]).all()
    for block in pieces(reader, 0.0, "mould"):
        assert (block["gap"] == 0.0).all()


def test_bodies_that_do_not_melt_have_no_solid_fraction_and_no_foundry_quantities(
    comm, shared_tmp_path
):
    mesh = cylinder_mesh(comm, size=5e-3)
    names = ("temperature", "solid_fraction", "niyama")
    solidification, disk = Solidification(mesh, {}), Disk(comm)
    fields = Fields(shared_tmp_path, names, None, mesh, solidification, disk, ["casting"], "vtu")
    fields.update(FakeSnapshot(0.0, 0, mesh, casting_pairs(mesh), FORMULAS))
    comm.Barrier()
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    for name, known in (("casting", set(names)), ("mould", {"temperature"})):
        for block in pieces(reader, 0.0, name):
            assert set(block.point_data) == known
            assert list(block.field_data["name"]) == [name]


class Counted:
    """A source of foundry quantities that counts how often it is asked."""

    def __init__(self, mesh):
        self.mesh, self.value, self.asked = mesh, 0.0, 0

    def nodal(self, body, name):
        self.asked += 1
        return np.full(len(self.mesh.bodies[body].points), self.value)


def test_foundry_quantities_are_found_only_for_moments_that_are_written(comm, shared_tmp_path):
    """Eight states, of which four are written; a new stage begins with the seventh."""
    mesh = cylinder_mesh(comm, size=5e-3)
    source = Counted(mesh)
    names = ("temperature", "niyama", "cooling_rate")
    fields = Fields(shared_tmp_path, names, 2.0, mesh, source, Disk(comm), ["casting"], "vtu")
    for step in range(8):
        process = ProcessState(stage=int(step >= 6))
        snapshot = FakeSnapshot(0.5 * step, step, mesh, formulas=FORMULAS, process=process)
        fields.leave_stage(snapshot)
        source.value = 0.5 * step
        fields.update(snapshot)
    fields.write_pending()
    comm.Barrier()
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    assert reader.time_values == [0.0, 2.0, 2.5, 3.5]
    for time in reader.time_values:
        for block in pieces(reader, time, "casting"):
            assert (block["niyama"] == time).all() and (block["cooling_rate"] == time).all()
    assert source.asked == 2 * 4


def test_every_field_has_a_unit():
    assert set(UNITS) == set(FIELDS)


def test_first_last_and_every_are_written(comm, shared_tmp_path):
    write(comm, shared_tmp_path, [0.0, 0.4, 0.9, 1.0, 1.7, 2.3, 4.1, 4.2], 1.0)
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    assert reader.time_values == [0.0, 1.0, 2.0, 3.0, 4.0, 4.2]


def test_multiples_of_every_hit_with_roundoff_count(comm, shared_tmp_path):
    times = [0.0, 0.1, 0.2, 0.1 + 0.2, 0.4, 0.5, 0.6 - 1e-16]
    write(comm, shared_tmp_path, times, 0.3)
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    assert reader.time_values == pytest.approx([0.0, 0.3, 0.6])


def test_the_collection_is_whole_after_every_output(comm, shared_tmp_path):
    mesh = cylinder_mesh(comm, size=5e-3)
    pairs = casting_pairs(mesh)
    solidification, disk = Solidification(mesh, {}), Disk(comm)
    fields = Fields(shared_tmp_path, ["temperature"], 1.0, mesh, solidification, disk, form="vtu")
    for step in range(3):
        fields.update(FakeSnapshot(float(step), step, mesh, pairs, FORMULAS))
        comm.Barrier()
        reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
        assert reader.time_values == [float(time) for time in range(step + 1)]
        assert sum(block.n_cells for block in reader.read()) > 0
        comm.Barrier()


@pytest.mark.ranks
def test_outputs_go_on_behind_those_that_are_kept(comm, shared_tmp_path):
    """Later pieces go; a body may have had pieces of other ranks."""
    mesh = write(comm, shared_tmp_path, [0.0, 1.0, 2.0, 3.0], 1.0)
    disk = Disk(comm)
    fields = Fields(shared_tmp_path, NAMES, 1.0, mesh, Solidification(mesh, {}), disk, form="vtu")
    holders = {"casting": [0], "mould": [0]}
    fields.resume([{"time": 0.0, "holders": holders}, {"time": 1.0, "holders": holders}])
    disk.raise_failures()
    left = {path.name for path in shared_tmp_path.glob("*.vtu")}
    assert left == {f"{body}_0000{index}_0.vtu" for body in holders for index in range(2)}
    comm.Barrier()
    pairs = casting_pairs(mesh)
    fields.go_on({"casting": None, "reached": []}, FakeSnapshot(1.0, 4, mesh, pairs, FORMULAS))
    for step, time in enumerate([1.4, 2.5], start=5):
        fields.update(FakeSnapshot(time, step, mesh, pairs, FORMULAS))
    assert fields.notes()[:2] == [{"time": float(t), "holders": holders} for t in range(2)]
    comm.Barrier()
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    assert reader.time_values == [0.0, 1.0, 2.0]
    assert sum(block.n_cells for block in pieces(reader, 2.0, "casting")) > 0


@pytest.mark.ranks
def test_fields_of_a_time_within_a_step_are_linear_in_time(comm, shared_tmp_path):
    mesh = cylinder_mesh(comm, size=5e-3)
    source, disk = Solidification(mesh, {}), Disk(comm)
    fields = Fields(shared_tmp_path, ["temperature"], 1.0, mesh, source, disk, form="vtu")
    for step, time in enumerate([0.0, 0.7, 2.7]):
        warm = {"temperature": lambda x, time=time: 100.0 * time + 1000.0 * x[:, 0]}
        fields.update(FakeSnapshot(time, step, mesh, casting_pairs(mesh), warm))
    comm.Barrier()
    reader = pyvista.get_reader(shared_tmp_path / "castx.pvd")
    assert reader.time_values == [0.0, 1.0, 2.0]
    for block in pieces(reader, 2.0, "casting"):
        np.testing.assert_allclose(block["temperature"], 200.0 + 1000.0 * block.points[:, 0])
