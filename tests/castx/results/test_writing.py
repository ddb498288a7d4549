"""The results folder as a whole: what is there after each way in which a run can end."""

import json
from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.domain.mesh import build_mesh
from castx.errors import CaseError, ConvergenceError
from castx.results.files.series import read_series
from castx.results.reading import Results
from castx.results.writing import ResultsWriter, wanted_fields
from castx.solvers.counters import StepCounters
from castx.transfer.database import interface_entry
from tests.castx.fakes import FakeSnapshot, casting_pairs

CONTENT = {
    "geometry": {
        "generator": "cylinder_in_mould",
        "model": "axisymmetric",
        "radius": "20 mm",
        "height": "40 mm",
        "wall": "10 mm",
        "size": "5 mm",
    },
    "bodies": [
        {"name": "casting", "material": "Al-pure", "temperature": 670},
        {"name": "mould", "material": "steel-H13", "temperature": 200},
    ],
    "interfaces": [
        {"bodies": ["casting", "mould"], "heat": {"law": "constant", "closed": 1000}},
    ],
    "time": {"end": 10, "first_step": 0.1, "largest_step": 1},
    "probes": [
        {"name": "p", "body": "casting", "at": [0, 0.02], "quantities": ["temperature"]},
    ],
}
LINEAR = {"temperature": lambda x: 300.0 + x[:, 0]}


def run(comm, folder, ending=None, **output):
    case = read_case({**CONTENT, "output": {"folder": str(folder), **output}}, Path("case.toml"))
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    pairs = casting_pairs(mesh)
    with ResultsWriter(case, mesh, pairs) as results:
        for step in range(3):
            counters = StepCounters(step=0.5, passes=2, cutbacks=step)
            totals = {"energy_error": float("nan"), "casting.enthalpy": 7.0}
            snapshot = FakeSnapshot(0.5 * step, step, mesh, pairs, LINEAR, totals, counters)
            results.write(snapshot)
        if ending is not None:
            raise ending
    comm.Barrier()


def record(folder):
    return json.loads((folder / "run.json").read_text())


def test_the_record_keeps_the_numbers_that_an_interface_takes_from_the_database(
    comm, shared_tmp_path, monkeypatch
):
    heat = {"from": "aluminium-steel-coated", "closed": 900}
    interfaces = [{"bodies": ["casting", "mould"], "heat": heat}]
    monkeypatch.setitem(CONTENT, "interfaces", interfaces)
    run(comm, shared_tmp_path)
    kept = record(shared_tmp_path)["interfaces"]["casting/mould"]
    assert kept["heat"] == "series"
    assert kept["heat_keys"] == {**interface_entry(heat["from"]).heat, **heat}
    case = json.loads((shared_tmp_path / "case.json").read_text())
    assert case["interfaces"][0]["heat"] == kept["heat_keys"]


def test_a_finished_run_leaves_everything(comm, shared_tmp_path):
    run(comm, shared_tmp_path)
    written = record(shared_tmp_path)
    assert written["exit"] == {"reason": "finished", "message": ""}
    assert written["totals"]["steps"] == 2
    assert written["totals"]["cutbacks"] == 3 and written["totals"]["passes"] == 4
    assert written["last"] == {"energy_error": None, "casting.enthalpy": 7.0}
    assert written["ranks"] == comm.size and written["time_reached"] == 1.0
    assert written["bodies"]["casting"]["material"] == "Al-pure"
    assert written["bodies"]["casting"]["nodes"] == 5 * 9
    assert written["bodies"]["casting"]["tearing"] is None  # a pure metal
    assert written["interfaces"]["casting/mould"]["pairs"] == 9
    memory = written["peak_memory"]
    assert 1e7 < memory["largest_rank"] <= memory["all_ranks"] < 1e11
    np.testing.assert_array_equal(read_series(shared_tmp_path / "probes.csv")["time"], [0, 0.5, 1])
    assert len(read_series(shared_tmp_path / "history.csv")["time"]) == 3
    assert Results(shared_tmp_path).times == [0.0, 1.0]
    copy = json.loads((shared_tmp_path / "case.json").read_text())
    assert copy == {**CONTENT, "output": {"folder": str(shared_tmp_path)}}
    assert read_case(copy, Path("case.toml")).digest == written["case"]["digest"]


@pytest.mark.parametrize(
    "ending, reason",
    [(ConvergenceError("no step"), "not converged"), (KeyboardInterrupt(), "interrupted")],
)
def test_the_last_accepted_state_is_there_after_a_common_end(comm, shared_tmp_path, ending, reason):
    with pytest.raises(type(ending)):
        run(comm, shared_tmp_path, ending)
    comm.Barrier()
    assert record(shared_tmp_path)["exit"] == {"reason": reason, "message": str(ending)}
    assert Results(shared_tmp_path).times == [0.0, 1.0]


@pytest.mark.ranks
def test_a_bug_is_recorded_too(comm, shared_tmp_path):
    with pytest.raises(ZeroDivisionError):
        run(comm, shared_tmp_path, ZeroDivisionError("division by zero"))
    comm.Barrier()
    assert record(shared_tmp_path)["exit"]["reason"] == "failed"


@pytest.mark.ranks
def test_a_signal_while_the_disk_is_full_raises_nothing(comm, shared_tmp_path, monkeypatch):
    content = {**CONTENT, "output": {"folder": str(shared_tmp_path)}}
    case = read_case(content, Path("case.toml"))
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    with ResultsWriter(case, mesh, casting_pairs(mesh)) as results:
        before = record(shared_tmp_path)
        comm.Barrier()

        def no_space(*_: object) -> None:
            raise OSError(28, "No space left on device")

        with monkeypatch.context() as full:
            full.setattr("castx.results.record.write_whole", no_space)
            results.note_interruption()
        assert record(shared_tmp_path) == before
        comm.Barrier()
        results.note_interruption()
        comm.Barrier()
        assert record(shared_tmp_path)["exit"]["reason"] == "interrupted"
        comm.Barrier()


def test_a_thermal_run_writes_what_it_has_and_refuses_what_it_has_not(comm, shared_tmp_path):
    thermal = {**CONTENT, "coupling": {"scheme": "thermal"}}
    output = {"folder": str(shared_tmp_path)}
    case = read_case({**thermal, "output": output}, Path("case.toml"))
    assert wanted_fields(case) == ["temperature", "solid_fraction", "solidification_time"]
    heavy = {**thermal, "loads": {"gravity": [0, -9.81]}, "output": output}
    assert wanted_fields(read_case(heavy, Path("case.toml")))[-1] == "emptied"
    asked = {**output, "fields": ["temperature", "gap"]}
    assert wanted_fields(read_case({**thermal, "output": asked}, Path("case.toml")))[1:] == ["gap"]
    mechanical = {**CONTENT, "coupling": {"scheme": "mechanical"}, "output": output}
    mechanical["bodies"] = [{**body, "temperature_history": 20} for body in CONTENT["bodies"]]
    assert wanted_fields(read_case(mechanical, Path("case.toml"))) == [
        "temperature", "displacement", "von_mises", "gap",
    ]  # fmt: skip
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    case = read_case({**thermal, "output": {**output, "fields": ["stress"]}}, Path("case.toml"))
    with pytest.raises(CaseError, match=r"output.fields: there is no stress in a run with"):
        ResultsWriter(case, mesh, casting_pairs(mesh))
    moving = {"name": "p", "body": "casting", "at": [0, 0.02], "quantities": ["displacement"]}
    case = read_case({**thermal, "output": output, "probes": [moving]}, Path("case.toml"))
    with pytest.raises(CaseError, match="probe 'p': there is no displacement"):
        ResultsWriter(case, mesh, casting_pairs(mesh))


def test_old_results_are_replaced_but_not_by_a_refused_case(comm, shared_tmp_path):
    run(comm, shared_tmp_path, every=0.5)
    before = record(shared_tmp_path)["case"]["digest"]
    comm.Barrier()
    far = {"name": "p", "body": "casting", "at": [0.5, 0.02], "quantities": ["temperature"]}
    case = read_case(
        {**CONTENT, "probes": [far], "output": {"folder": str(shared_tmp_path)}}, Path("case.toml")
    )
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    with pytest.raises(CaseError, match="outside body 'casting'"):
        ResultsWriter(case, mesh, casting_pairs(mesh))
    assert record(shared_tmp_path)["case"]["digest"] == before
    comm.Barrier()
    run(comm, shared_tmp_path)
    assert Results(shared_tmp_path).times == [0.0, 1.0]
    assert {path.name for path in (shared_tmp_path / "fields").iterdir()} == {
        "casting.hdf", "mould.hdf"
    }  # fmt: skip
