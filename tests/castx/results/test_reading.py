"""A results folder read back: what was written comes out, on any number of ranks and stages."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista

from castx.case.output import FORMATS
from castx.case.reading.read import load_case
from castx.command.run import run
from castx.errors import CaseError
from castx.foundry.front.solidification import Solidification
from castx.results.fields import Fields
from castx.results.files.disk import Disk
from castx.results.reading import Results, facing_nodes
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh

FORMULAS = {
    "temperature": lambda x: 300.0 + 1e4 * x[:, 0],
    "displacement": lambda x: -1e-3 * x,
    "gap": lambda x: 1e-5 * x[:, 1],
    "stress": lambda x: 1e6 * (1.0 + np.arange(6.0)) + x[:, :1],
}


def results_folder(comm, folder, model="axisymmetric", form="vtkhdf"):
    """Write the fields of two moments at all ranks, with the tables that belong to them."""
    mesh = cylinder_mesh(comm, model, 5e-3)
    pairs = casting_pairs(mesh)
    count = comm.allreduce(len(pairs["casting/mould"].areas))
    if comm.rank == 0:
        (folder / "fields").mkdir(parents=True)
        record = {
            "castx": "0",
            "case": {"name": "formulas", "file": "formulas.toml"},
            "model": model,
            "bodies": {"casting": {}, "mould": {}},
            "interfaces": {"casting/mould": {"pairs": count}},
        }
        (folder / "run.json").write_text(json.dumps(record))
        (folder / "history.csv").write_text("time,casting.solid_fraction\n0,0.5\n1,1\n")
        (folder / "probes.csv").write_text("time,centre.temperature\n0,700\n1")
    comm.Barrier()
    source, disk = Solidification(mesh, {}), Disk(comm)
    writer = Fields(folder / "fields", tuple(FORMULAS), 1.0, mesh, source, disk, form=form)
    for step, time in enumerate((0.0, 1.0)):
        writer.update(FakeSnapshot(time, step, mesh, pairs, FORMULAS))
    writer.write_pending()
    comm.Barrier()
    return folder


@pytest.fixture(params=FORMATS)
def results(comm, shared_tmp_path, request):
    return Results(results_folder(comm, shared_tmp_path / "out", form=request.param))


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_fields_come_back_at_their_points(comm, shared_tmp_path, model, form):
    results = Results(results_folder(comm, shared_tmp_path / "out", model, form))
    gdim = 3 if model == "3d" else 2
    assert results.model == model and results.times == [0.0, 1.0]
    temperature = results.field("temperature", "casting", 0.0)
    assert temperature.points.shape[1] == gdim and not temperature.in_cells
    np.testing.assert_allclose(temperature.values, FORMULAS["temperature"](temperature.points))
    displacement = results.field("displacement", "mould")
    np.testing.assert_allclose(displacement.values, -1e-3 * displacement.points, atol=1e-18)
    assert displacement.time == 1.0
    stress = results.field("stress", "casting")
    centres = stress.points[stress.cells].mean(axis=1)
    assert stress.in_cells
    np.testing.assert_allclose(stress.values, FORMULAS["stress"](centres))


@pytest.mark.ranks
def test_pieces_of_all_ranks_are_one_body(comm, results):
    mesh = cylinder_mesh(comm, "axisymmetric", 5e-3)
    for name, body in mesh.bodies.items():
        grid = results.grids()[name]
        assert grid.n_points == body.nodes.dofmap.index_map.size_global
        assert grid.n_cells == body.mesh.topology.index_map(2).size_global


@pytest.mark.ranks
def test_an_interface_has_the_nodes_that_touch(results):
    found = results.interface("casting/mould")
    np.testing.assert_allclose(found.points[:, 0], 0.02, atol=1e-12)
    assert len(found.points) == results.record["interfaces"]["casting/mould"]["pairs"]
    np.testing.assert_allclose(found.values["gap"], 1e-5 * found.points[:, 1], atol=1e-12)
    np.testing.assert_allclose(found.values["temperature"], 500.0)
    assert found.time == 1.0


def test_tables_are_columns_without_a_line_cut_short(results):
    assert results.history["casting.solid_fraction"].tolist() == [0.5, 1.0]
    assert results.probes["centre.temperature"].tolist() == [700.0]
    assert results.freezing == ["casting"]
    assert results.case["name"] == "formulas" and results.bodies == ("casting", "mould")


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda r: r.probes["center.temperature"], 'did you mean "centre.temperature"'),
        (lambda r: r.history["gap"], "there are: time, casting.solid_fraction"),
        (lambda r: r.field("temprature", "casting"), 'did you mean "temperature"'),
        (lambda r: r.field("body", "casting"), "no field 'body' was written"),
        (lambda r: r.field("gap", "core"), "no body 'core' at 1 s; known: casting, mould"),
        (lambda r: r.grids(0.5), "no fields were written at 0.5 s; times of fields: 0, 1 s"),
        (lambda r: r.interface("mould/casting"), "no interface 'mould/casting'"),
        (lambda r: r.interface("casting/mould").values["h"], "there are: displacement, gap"),
    ],
)
def test_what_is_not_there_is_refused_with_what_is(results, ask, message):
    with pytest.raises(CaseError, match=message):
        ask(results)


def test_fields_and_probes_have_units(results):
    assert results.units("casting") == {
        "temperature": "°C", "displacement": "m", "gap": "m", "stress": "Pa"
    }  # fmt: skip
    assert results.unit("centre.temperature") == "°C" and results.unit("time") == "s"
    with pytest.raises(CaseError, match=r'did you mean "centre\.temperature"'):
        results.unit("center.temperature")


def test_fields_over_time_have_all_moments(results):
    found = results.over_time("temperature", "casting")
    np.testing.assert_array_equal(found.times, [0.0, 1.0])
    expected = FORMULAS["temperature"](found.points)
    np.testing.assert_allclose(found.values, [expected, expected])
    stress = results.over_time("stress", "mould")
    assert stress.values.shape == (2, len(stress.points), 6)
    np.testing.assert_allclose(stress.values[1], FORMULAS["stress"](stress.points))
    with pytest.raises(CaseError, match="no body 'core'; known: casting, mould"):
        results.over_time("temperature", "core")


@pytest.mark.ranks
def test_gaps_of_an_interface_are_followed_over_time(results):
    found = results.interface_over_time("casting/mould", "gap")
    assert found.values.shape == (2, len(found.points))
    np.testing.assert_allclose(found.values[0], 1e-5 * found.points[:, 1], atol=1e-12)
    with pytest.raises(CaseError, match="there are: displacement, gap"):
        results.interface_over_time("casting/mould", "h")
    with pytest.raises(CaseError, match="no interface 'mould/casting'"):
        results.interface_over_time("mould/casting", "gap")


def test_get_and_in_work_as_for_any_mapping(results):
    assert results.history.get("gap") is None and "gap" not in results.history


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(CaseError, match="is not a results folder of castx"):
        Results(tmp_path)
    for name in ("history.csv", "probes.csv"):
        (tmp_path / name).write_text("time\n")
    (tmp_path / "run.json").write_text('{"bodies": {}}')
    with pytest.raises(CaseError, match="holds no accepted step"):
        Results(tmp_path)


@pytest.mark.parametrize("form, pattern", [("vtkhdf", "*.hdf"), ("vtu", "castx.pvd")])
def test_a_run_without_fields_has_tables_only(comm, shared_tmp_path, form, pattern):
    folder = results_folder(comm, shared_tmp_path / "out", form=form)
    comm.Barrier()
    if comm.rank == 0:
        for path in (folder / "fields").glob(pattern):
            path.unlink()
    comm.Barrier()
    results = Results(folder)
    assert len(results.history["time"]) == 2
    with pytest.raises(CaseError, match="there are no fields"):
        results.times  # noqa: B018


STAGES = ["stages.0.at=0.2", "stages.1.at=0.3", "time.end=0.4", "output.every=0.1"]


def test_a_body_that_is_removed_is_missed_at_its_time_only(comm, shared_tmp_path):
    case = load_case("demos/stages.toml")
    removed = case.stages[0].remove[0]
    folder = run("demos/stages.toml", STAGES, output=shared_tmp_path / "out", comm=comm)
    results = Results(folder)
    assert removed in results.grids(0.0) and removed in results.bodies
    assert removed not in results.grids()
    with pytest.raises(CaseError, match=f"no body '{removed}' at 0.4 s"):
        results.interface(f"casting/{removed}")
    found = results.interface(f"casting/{removed}", 0.0)
    assert len(found.points) == results.record["interfaces"][f"casting/{removed}"]["pairs"]


@pytest.mark.ranks
def test_an_interface_of_meshes_with_a_gap_has_the_nearest_nodes():
    left = pyvista.ImageData(dimensions=(4, 6, 1)).cast_to_unstructured_grid()
    right = pyvista.ImageData(dimensions=(4, 4, 1), origin=(5.0, 0.0, 0.0), spacing=(1, 5 / 3, 1))
    found = facing_nodes(left, right.cast_to_unstructured_grid(), pairs=6)
    assert sorted(left.points[found, 1]) == [0, 1, 2, 3, 4, 5]
    assert (left.points[found, 0] == 3.0).all()
