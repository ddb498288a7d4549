"""The plastic strain rate: against the plastic strains that are written before and after a step."""

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.fields.plastic_strain_rate import FIELDS
from castx.case.reading.read import read_case
from castx.command.run import RunSettings, run_case
from castx.results.reading import Results
from tests.castx.case.fields.samples import KnownState, displayed
from tests.castx.process.test_stages import FLOWING
from tests.coupled_cases import merged, ring, simulation

NAMES = ["plastic_strain", "plastic_strain_rate"]
STEP = 0.5


def flowing(**output):
    """Return a hot, solid ring that yields while it shrinks onto its core, in steps of 0.5 s."""
    data = merged(
        ring({"time": {"end": 2.0, "fixed_step": STEP}}), {"materials": {"aluminium": FLOWING}}
    )
    data["bodies"][0] |= {"temperature": 600.0, "law": "thermo-elasto-viscoplastic"}
    data["output"] = {"fields": NAMES, "every": STEP, **output}
    probe = {"name": "p", "body": "casting", "at": [0.032, 0.02], "quantities": NAMES}
    return data | {"probes": [probe]}


def case(folder):
    return read_case(flowing(folder=str(folder)), Path("case.toml"))


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    comm = MPI.COMM_WORLD
    folder = comm.bcast(tmp_path_factory.mktemp("rate"))
    return Results(run_case(case(folder / "out"), RunSettings(comm)))


def differences(found, body):
    """Return the rates at all but the first written moment, and those that strains make."""
    strain, rate = (found.over_time(name, body) for name in NAMES)
    steps = np.diff(strain.times)[:, None]
    return rate.values[1:], np.diff(strain.values, axis=0) / steps


def test_rates_are_differences_of_written_strains_over_the_step(written):
    assert written.times == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0])
    found, expected = differences(written, "casting")
    assert expected.max() > 1e-4, "nothing has yielded"
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_rates_of_the_initial_state_and_of_elastic_bodies_are_zero(written):
    assert (written.field("plastic_strain_rate", "casting", 0.0).values == 0.0).all()
    assert (written.over_time("plastic_strain_rate", "core").values == 0.0).all()
    assert written.units("casting")["plastic_strain_rate"] == "1/s"


def test_a_probe_records_the_rate(written):
    times, strain = written.probes["time"], written.probes["p.plastic_strain"]
    assert written.probes["p.plastic_strain_rate"][0] == 0.0
    expected = np.diff(strain) / np.diff(times)
    assert written.probes["p.plastic_strain_rate"][1:] == pytest.approx(expected, rel=1e-6)
    assert expected.max() > 1e-5


def test_a_run_that_goes_on_has_the_rates_of_one_that_was_never_interrupted(
    comm, shared_tmp_path, written
):
    folder = shared_tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        run_case(case(folder), RunSettings(comm, time_limit=1e-6))
    comm.Barrier()
    run_case(case(folder), RunSettings(comm, restart=True))
    found, expected = differences(Results(folder), "casting")
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert found == pytest.approx(differences(written, "casting")[0], rel=1e-4, abs=1e-8)


@pytest.mark.ranks
def test_a_restored_state_has_no_rate_until_its_next_step(comm):
    """What the step before a checkpoint has gained is not in it."""
    stepped = simulation(comm, flowing())
    saved, expected = {}, np.zeros(0)
    for state in stepped:
        if state.step == 1:
            saved = {name: array.values.copy() for name, array in stepped.saved().items()}
        if state.step == 2:
            expected = state.cellwise("casting", NAMES[1]).copy()
    assert comm.allreduce(float(expected.max(initial=0.0))) > 0.0
    resumed = simulation(comm, flowing())
    resumed.restore(saved)
    assert (resumed.state().cellwise("casting", NAMES[1]) == 0.0).all()
    state = next(iter(resumed))
    assert state.step == 2
    assert state.cellwise("casting", NAMES[1]) == pytest.approx(expected, rel=1e-4, abs=1e-8)
    stepped.destroy()
    resumed.destroy()


@pytest.mark.serial
def test_the_rate_of_known_increments():
    (field,) = FIELDS
    state = KnownState(step_size=0.25)
    assert field.values(state) == pytest.approx(4.0 * state.increment)
    assert displayed(field, 2e-3) == "0.002 1/s"
