"""Identification of known numbers: constant, table, depth, clock; coverage; a real run."""

import json

import numpy as np
import pytest

from castx.case.reading.read import load_case
from castx.command.run import run
from castx.errors import CaseError, UnsettledFit
from castx.studies.inverse.identify import PAGE, RESULT, identify
from tests.castx.cooled_mould import TIME, formula, h_of, measured
from tests.castx.many_runs import CASE, Formulas
from tests.castx.studies.inverse.in_process import InProcess
from tests.castx.studies.inverse.measured_case import opened

pytestmark = pytest.mark.serial


def found_in(result):
    return {one.name: one for one in result.found.estimates}


def test_a_number_is_found_within_its_band(tmp_path):
    runner, study = opened(tmp_path)
    result = identify(runner, study)
    (one,) = result.found.estimates
    assert one.low < 1400.0 < one.high and abs(one.value / 1400.0 - 1.0) < 0.01
    assert one.unit == "W/m^2/K" and not one.at_bound
    assert result.found.fit.chi_square == pytest.approx(1.0, abs=0.4)
    assert result.found.unseen == [] and result.found.whiteness[0].endswith("noise.")
    assert result.found.remarks == []
    written = load_case(result.case_file)
    assert result.case_file == tmp_path / "case.identified.toml"
    assert h_of(written.content)[0] == one.value
    (curve,) = written.measurements
    assert (curve.of, curve.file) == ("near.temperature", tmp_path / "near.csv")
    record = json.loads((tmp_path / "study" / RESULT).read_text())
    assert record["estimates"][0]["value"] == one.value and record["estimates"][0]["known"] is None
    page = (tmp_path / "study" / PAGE).read_text()
    assert f"{one.value:.5g} W/m^2/K" in page and "Sensor near.temperature" in page


def test_a_table_a_depth_and_a_clock(tmp_path):
    """Of an h that falls from 2000 to 500 in ln, and a sensor 0.2 mm deeper than its hole.

    All is found within three deviations; where the depth is said to be known, h is too low.
    """
    h = 2000.0 * 0.25 ** (np.minimum(TIME, 30.0) / 30.0)
    text = measured(h, 2.2e-3, 0.2, 3)
    table = {"over": "time", "knots": ["0 s", "10 s", "30 s"], "start": "900 W/m^2/K"}
    exact = {"h at 0 s": 2000.0, "h at 10 s": 2000.0 * 0.25 ** (1 / 3), "h at 30 s": 500.0}
    known = {"deviation": 1.0, "smoothness": 5.0}
    runner, study = opened(
        tmp_path, text, depth=True, unknown={**table, **known}, clock_deviation="0.5 s"
    )
    result = identify(runner, study)
    found = found_in(result)
    for name, value in exact.items():
        assert abs(np.log(found[name].value / value)) < 3.0 * found[name].deviation, name
    assert abs(found["depth of near"].value - 2e-4) < 3.0 * found["depth of near"].deviation
    assert found["depth of near"].unit == "m" and found["clock"].unit == "s"
    (band,) = result.tables
    assert (band.abscissa, band.unit) == ("time [s]", found["h at 0 s"].unit)
    assert found["h at 0 s"].unit.startswith("W/m")
    assert np.all((band.low < band.value) & (band.value < band.high))
    assert band.value[0] == pytest.approx(found["h at 0 s"].value)
    assert band.high[0] == pytest.approx(found["h at 0 s"].high)
    certain, _ = opened(tmp_path, text, unknown=table)
    wrong = found_in(identify(certain, opened(tmp_path, text, unknown=table)[1]))
    off = np.log(wrong["h at 0 s"].value / 2000.0)
    assert off < -3.0 * wrong["h at 0 s"].deviation  # deeper is colder: h seems less


def test_a_second_study_makes_no_run(tmp_path):
    first, study = opened(tmp_path)
    identify(first, study)
    again, study = opened(tmp_path)
    identify(again, study)
    assert first.made > 3 and again.made == 0


def test_a_killed_study_finds_the_same(tmp_path):
    dying, study = opened(tmp_path, executor=Formulas(formula, dies_after=4))
    with pytest.raises(KeyboardInterrupt):
        identify(dying, study)
    runner, study = opened(tmp_path)
    resumed = found_in(identify(runner, study))["h"]
    (tmp_path / "other").mkdir()
    whole = found_in(identify(*opened(tmp_path / "other")))["h"]
    assert (resumed.value, resumed.deviation) == (whole.value, whole.deviation)


def test_more_than_noise_is_told(tmp_path):
    """A mould that forgets: the measured curve bends as no h does."""
    lines = measured(1400.0, 2e-3, 0.1).splitlines()
    bent = [lines[0]]
    for line in lines[1:]:
        time, value = map(float, line.split(","))
        bent.append(f"{time},{value + 10.0 * np.sin(time / 4.0)}")
    result = identify(*opened(tmp_path, "\n".join(bent) + "\n"))
    assert any("χ²_r" in text and "wants a table" in text for text in result.found.remarks)
    assert "not what the model lacks" in result.found.whiteness[0]


def test_a_bound_that_holds_is_told(tmp_path):
    bound = {"low": "500 W/m^2/K", "high": "1200 W/m^2/K", "start": "800 W/m^2/K"}
    result = identify(*opened(tmp_path, unknown=bound))
    (one,) = result.found.estimates
    assert one.at_bound and one.value == pytest.approx(1200.0, rel=1e-3)
    assert any("A bound holds h" in text for text in result.found.remarks)


def test_unknowns_that_cannot_be_told_apart_are_refused(tmp_path):
    """The knot at 39.9 s is beyond nearly all samples: what is known before must tell it."""
    table = {"over": "time", "knots": [0, 39, 39.9], "start": 900}
    seen = identify(*opened(tmp_path, unknown={**table, "deviation": 0.3}))
    assert any("hardly see h at 39.9" in text for text in seen.found.unseen)
    with pytest.raises(CaseError, match=r"h at (100|200) s has no influence|least of all h at 200"):
        identify(*opened(tmp_path, unknown={**table, "knots": [0, 100, 200]}))


def test_a_fit_tells_how_near_it_has_come(tmp_path, caplog):
    caplog.set_level("INFO")
    identify(*opened(tmp_path, unknown={"start": 700}))
    told = [record.args[0] for record in caplog.records if "times the noise" in record.msg]
    assert len(told) > 1 and told == sorted(told, reverse=True)
    assert told[0] > 10.0 and told[-1] == pytest.approx(1.0, abs=0.2)


def test_a_fit_that_does_not_settle_is_no_result(tmp_path):
    with pytest.raises(UnsettledFit, match=r"not settled.*raise tries"):
        identify(*opened(tmp_path, tries=1))


def test_runs_of_castx_tell_the_coefficient(comm, tmp_path):
    """A coefficient of 1300 and a sensor 0.2 mm deeper than its hole, with noise of 0.2 K."""
    heated = "\n".join([CASE.replace("end = 6", "end = 12")])
    truth = tmp_path / "truth.toml"
    truth.write_text(heated)
    made = run(truth, ["interfaces.0.heat.closed=1300", "probes.0.depth=2.2e-3"], comm=comm,
               output=tmp_path / "truth")  # fmt: skip
    rows = np.loadtxt(made / "probes.csv", delimiter=",", skiprows=1)
    rows[:, 1] += 0.2 * np.random.default_rng(1).normal(size=len(rows))
    lines = ["time,near.temperature", *(f"{t},{y}" for t, y in rows)]
    runner, study = opened(
        tmp_path, "\n".join(lines) + "\n", depth=True, executor=InProcess(comm),
        unknown={"deviation": 0.5},
    )  # fmt: skip
    (tmp_path / "case.toml").write_text(heated)
    found = found_in(identify(runner, study))
    assert abs(np.log(found["h"].value / 1300.0)) < 3.0 * found["h"].deviation < 0.2
    assert abs(found["depth of near"].value - 2e-4) < 3.0 * found["depth of near"].deviation


@pytest.mark.slow
def test_both_engines_lie_within_each_others_bands(comm, tmp_path):
    """Of runs of castx with noise of 0.5 K: h and the conductivity of the mould."""
    text = CASE.replace("end = 6", "end = 12")
    (tmp_path / "truth.toml").write_text(text)
    made = run(tmp_path / "truth.toml", ["interfaces.0.heat.closed=1300"], comm=comm,
               output=tmp_path / "truth")  # fmt: skip
    rows = np.loadtxt(made / "probes.csv", delimiter=",", skiprows=1)
    rows[:, 1] += 0.5 * np.random.default_rng(2).normal(size=len(rows))
    curve = "\n".join(["time,near.temperature", *(f"{t},{y}" for t, y in rows)]) + "\n"
    found = []
    for engine in ("levenberg-marquardt", "ensemble"):
        (tmp_path / engine).mkdir()
        runner, study = opened(
            tmp_path / engine, curve, executor=InProcess(comm), unknown={"deviation": 0.5},
            others=[{"of": "materials.die.conductivity", "name": "k", "deviation": 0.1}],
            engine=engine, members=16, rounds=2,
        )  # fmt: skip
        (tmp_path / engine / "case.toml").write_text(text)
        found.append(found_in(identify(runner, study)))
    for name, truth in (("h", 1300.0), ("k", 35.0)):
        lm, ensemble = found[0][name], found[1][name]
        assert lm.low < ensemble.value < lm.high and ensemble.low < lm.value < ensemble.high
        assert lm.low < truth < lm.high


def test_an_ensemble_agrees_with_the_descent(tmp_path):
    """Within two posterior deviations of each other."""
    known = {"unknown": {"deviation": 0.3}}
    lm = found_in(identify(*opened(tmp_path, **known)))
    runner, study = opened(tmp_path, engine="ensemble", members=12, rounds=3, **known)
    found = found_in(identify(runner, study))
    one, other = lm["h"], found["h"]
    assert abs(np.log(other.value / one.value)) < 2.0 * one.deviation
    assert 0.3 < other.deviation / one.deviation < 2.0
    assert runner.made > 40


def test_a_study_without_curves_is_for_designs_only(tmp_path):
    place = {"name": "a", "body": "mould", "at": ["32 mm", "0.5 mm"], "depth_deviation": 0}
    with pytest.raises(CaseError, match="nothing was measured"):
        identify(*opened(tmp_path, candidates=[place], curves=[]))
