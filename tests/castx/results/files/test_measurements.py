"""Measured curves: read from tables of loggers, kept with the results, compared with probes."""

import re

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.output import Measurement
from castx.case.reading.read import read_case
from castx.command.run import RunSettings, run_case
from castx.errors import CaseError
from castx.input.problems import Refusal
from castx.results.files.measurements import (
    Measured,
    deviation,
    measured_curves,
    read_measured,
    read_measurement,
    write_measured,
)
from castx.results.reading import Results
from tests.castx.case_data import cylinder

OF = "centre.temperature"


def measurement(folder, text, **keys):
    """Return the measurement of a table in a folder."""
    (folder / "logger.csv").write_text(text)
    given = {"of": OF, "file": "logger.csv", **keys}
    return Measurement.read(given).relative_to(folder)


@pytest.mark.serial
@pytest.mark.parametrize(
    "text, keys, time, values",
    [
        ("time,centre.temperature\n0,660\n2,650.5\n", {}, [0, 2], [660, 650.5]),
        ("t [min];TC 1;TC 2\n0;1;660,5\n0,5;2;600\n",
         {"time": "t [min]", "time_unit": "min", "column": "TC 2"}, [0, 30], [660.5, 600]),
        ("\ufefftime\tT\n1\t933.15\n3\t833.15\n", {"column": "T", "unit": "K"}, [1, 3], [660, 560]),
        ("time,T\n10,1220\n20,\n,5\n30,1184\n40\n",
         {"column": "T", "unit": "degF", "start": "10 s"}, [0, 20], [660, 640]),
        ("time,d\n0,0.5\n1,-2\n",
         {"of": "rim.displacement.r", "column": "d", "unit": "mm"}, [0, 1], [5e-4, -2e-3]),
    ],
)  # fmt: skip
def test_tables_of_loggers(tmp_path, text, keys, time, values):
    found = read_measurement(measurement(tmp_path, text, **keys))
    np.testing.assert_allclose(found.time, time, atol=1e-12)
    np.testing.assert_allclose(found.values, values, rtol=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize(
    "text, keys, message",
    [
        ("time,T\n0,1\n", {}, "logger.csv: no column 'centre.temperature'; known: time, T"),
        ("t,centre.temperature\n0,1\n", {}, "no column 'time'"),
        ("time,centre.temperature\n0,hot\n", {}, "line 2: 'hot' is no number"),
        ("time,centre.temperature\n0,nan\n", {}, "line 2: 'nan' is no number"),
        ("time,centre.temperature\n0,1\n0,2\n", {}, "times must increase, and do not behind 0 s"),
        ("time,centre.temperature\n5,-300\n", {}, "-300 °C at 5 s of the run is below absolute"),
        ("time,centre.temperature\n", {}, "no line with a time and a number"),
        ("", {}, "no column 'time'"),
    ],
)
def test_tables_that_are_refused(tmp_path, text, keys, message):
    with pytest.raises(CaseError, match=message):
        read_measurement(measurement(tmp_path, text, **keys))


@pytest.mark.serial
def test_files_that_are_refused(tmp_path):
    given = measurement(tmp_path, "time")
    (tmp_path / "logger.csv").write_bytes(b"time\xff")
    with pytest.raises(CaseError, match="not a text in UTF-8"):
        read_measurement(given)
    (tmp_path / "logger.csv").unlink()
    with pytest.raises(CaseError, match="there is no such file"):
        read_measurement(given)


@pytest.mark.serial
@pytest.mark.parametrize(
    "keys, message",
    [
        ({"of": "centre"}, "PROBE.QUANTITY"),
        ({"of": "centre.temprature"}, 'did you mean "temperature"'),
        ({"unit": "mm"}, "unit: .*not a unit of temperature"),
        ({"time_unit": "K"}, "time_unit: .*not a unit of time"),
        ({"file": ""}, "file: the path of a table is needed"),
    ],
)
def test_what_contradicts_itself_is_refused(keys, message):
    with pytest.raises(Refusal) as caught:
        Measurement.read({"of": OF, "file": "logger.csv", **keys})
    assert re.search(message, str(caught.value))


@pytest.mark.ranks
def test_what_no_probe_records_is_refused_on_all_ranks(comm, shared_tmp_path):
    given = Measurement.read({"of": OF, "file": "logger.csv"}).relative_to(shared_tmp_path)
    with pytest.raises(CaseError, match=r"no probe records it.*did you mean .*center\.temperature"):
        measured_curves([given], ["center.temperature"], comm)
    with pytest.raises(CaseError, match="there is no such file"):
        measured_curves([given], [OF], comm)


@pytest.mark.serial
def test_the_difference_is_that_of_the_moments_within_the_run():
    """Computed: 10 t. Measured: 10 t + 1 at t = 1, 10 t - 3 at t = 2, others outside."""
    time = np.array([0.0, 1.5, 3.0])
    measured = Measured(np.array([-1.0, 1.0, 2.0, 9.0]), np.array([0.0, 11.0, 17.0, 0.0]))
    found = deviation(time, 10.0 * time, measured)
    assert found.root_mean_square == pytest.approx(np.sqrt(5.0), rel=1e-12)
    assert (found.largest, found.at, found.points) == (pytest.approx(3.0), 2.0, 2)
    removed = np.array([0.0, 15.0, np.nan])
    assert deviation(time, removed, measured).points == 1
    assert deviation(time, np.full(3, np.nan), measured) is None


@pytest.mark.serial
def test_the_copy_among_the_results_has_the_same_bits(tmp_path):
    curves = {OF: Measured(np.array([0.1, 1 / 3]), np.array([1e-17, 660.1])),
              "a, b.gap": Measured(np.array([0.0]), np.array([-2e-6]))}  # fmt: skip
    write_measured(tmp_path, curves)
    found = read_measured(tmp_path)
    assert found.keys() == curves.keys()
    for name, curve in curves.items():
        np.testing.assert_array_equal(found[name].time, curve.time)
        np.testing.assert_array_equal(found[name].values, curve.values)
    write_measured(tmp_path, {})
    assert read_measured(tmp_path) == {}


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """Return the results of a short run with a curve that lies 5 K above its probe."""
    folder = tmp_path_factory.mktemp("measured")
    (folder / "tc.csv").write_text("time,T\n0,675\n0.1,675\n0.2,675\n7,0\n")
    keys = {"of": "centre.temperature", "file": "tc.csv", "column": "T"}
    output = {"folder": str(folder / "out")}
    data = cylinder(geometry__size="6 mm", time__end=0.2, measurements=[keys], output=output)
    case = read_case(data, folder / "case.toml")
    assert case.measurements[0].file == folder / "tc.csv"
    return Results(run_case(case, RunSettings(MPI.COMM_SELF)))


@pytest.mark.serial
def test_a_run_is_compared_with_what_was_measured(compared):
    (found,) = compared.deviations.values()
    computed = compared.probes["centre.temperature"]
    expected = np.interp([0.0, 0.1, 0.2], compared.probes["time"], computed) - 675.0
    assert found.points == 3 and found.largest == pytest.approx(expected.min(), rel=1e-12)
    assert found.root_mean_square == pytest.approx(np.sqrt(np.mean(expected**2)), rel=1e-12)
