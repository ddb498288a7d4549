"""Experiments over ranges: the band holds what was measured, or the verdict says that it does not.

A lumped body cools by T = T_a + (T_0 - T_a) exp(-h A t/(ρ c V)); its start and its coefficient are
unknown, so that the exact band follows from the ends of their ranges.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from castx.errors import CaseError
from castx.proof.validation.band import (
    AnswerBand,
    MeasuredBand,
    banded,
    overrides_of,
    refuse_without_ranges,
)
from castx.proof.validation.band_page import curve_text, write_band_page
from castx.proof.validation.experiment import read_experiment
from castx.studies.runs.curves import Band
from castx.studies.runs.local import LocalProcesses
from castx.studies.runs.runner import study_folder
from tests.castx.proof.validation.synthetic import (
    AMBIENT,
    CAPACITY,
    CASE,
    COEFFICIENT,
    END,
    FACTS,
    LENGTH,
    START,
    write_experiment,
)

pytestmark = pytest.mark.serial

RANGES = """
[[ranges]]
of = "bodies.0.temperature"
name = "start"
low = 580
high = 620
because = "made up"
[[ranges]]
of = "boundaries.0.heat.coefficient"
low = 300
high = 700
because = "made up"
"""
DIGITS = """draws = 4
digits = [
  { name = "at the end", value = 605, unit = "K", uncertainty = 5 },
  { name = "far too hot", value = 500, unit = "°C" },
  { name = "hottest", value = "missing: not read", unit = "°C" },
]
answers = [
  { digit = "at the end", column = "middle.temperature" },
  { digit = "far too hot", column = "middle.temperature" },
  { digit = "hottest", column = "middle.temperature", moment = "largest" },
]
"""


def unknown(folder, ranges=RANGES):
    """Return the lumped body with an unknown start and coefficient."""
    folder = write_experiment(folder)
    head, tail = FACTS.split("digits = ")
    facts = head + DIGITS + tail.split("\n", 1)[1] + ranges
    (folder / "experiment.toml").write_text(facts)
    case = CASE.replace(f"temperature = {START}", 'temperature = "missing: start"')
    case = case.replace(f"coefficient = {COEFFICIENT}", 'coefficient = "missing: h"')
    case = case.replace("fixed_step = 0.1\nfirst_step = 0.1", "fixed_step = 0.5\nfirst_step = 0.5")
    (folder / "case.toml").write_text(case)
    return read_experiment(folder)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    root = tmp_path_factory.mktemp("band")
    experiment = unknown(root / "lumped")
    with study_folder(root / "study") as folder:
        made = banded(experiment, folder, LocalProcesses(2))
        return made, write_band_page(folder, experiment, made).read_text()


def exact(start, coefficient, time=END):
    return AMBIENT + (start - AMBIENT) * np.exp(-coefficient * time / (CAPACITY * LENGTH))


def test_the_band_lies_between_the_ends_of_the_ranges(found):
    made, _ = found
    assert made.finished == len(made.runs) == 4
    end, _, hottest = made.answers
    kelvin = 273.15
    assert exact(580, 700) + kelvin < end.lowest < end.highest < exact(620, 300) + kelvin
    values = [[run.changes[key] for run in made.runs]
              for key in ("bodies.0.temperature", "boundaries.0.heat.coefficient")]  # fmt: skip
    exactly = [exact(*pair) + kelvin for pair in zip(*values, strict=True)]
    assert [end.lowest, end.highest] == pytest.approx([min(exactly), max(exactly)], abs=1.5)
    assert [hottest.lowest, hottest.highest] == pytest.approx([min(values[0]), max(values[0])])


def test_what_was_measured_is_inside_outside_or_missing(found):
    made, _ = found
    assert [one.inside for one in made.answers] == [True, False, None]
    verdicts = [one.verdict for one in made.answers]
    assert verdicts[0] == "measured 605 ± 5 K: in the band"
    assert verdicts[1].endswith("outside the band") and "no digit was read" in verdicts[2]
    (curve,) = made.curves
    assert curve.share_inside is not None and curve.share_inside > 0.9
    assert "of the measured moments lie in the band" in curve_text(curve)


@pytest.mark.parametrize(
    ("measured", "uncertainty", "inside"),
    [(1.0, 0.0, True), (2.0, 0.0, True), (2.1, 0.0, False), (2.1, 0.2, True), (0.7, 0.2, False)],
)
def test_an_uncertain_digit_is_inside_when_it_meets_the_band(measured, uncertainty, inside):
    assert AnswerBand("a", "m", 1.0, 2.0, measured, uncertainty).inside is inside


@pytest.mark.parametrize(
    ("ends", "said"),
    [((1.0, 2.0), "in the band"), ((1.0, 2.1), "ends differ by a factor of 2.1: proves little"),
     ((-4.0, -1.0), "ends differ by a factor of 4: proves little"),
     ((-1.0, 2.0), "which spans zero: proves little")],
)  # fmt: skip
def test_a_wide_band_says_that_it_proves_little(ends, said):
    assert AnswerBand("a", "m", *ends, 0.5 * sum(ends), 0.0).verdict.endswith(said)
    assert AnswerBand("a", "m", *ends, 9.0, 0.0).verdict.endswith("outside the band")


def test_a_band_of_some_of_the_runs_contradicts_nothing():
    inside, outside = (AnswerBand("a", "m", 1.0, 2.0, at, 0.0, 3).verdict for at in (1.5, 9.0))
    assert inside.endswith("in the band")
    assert outside.endswith("outside the band, not decidable while 3 runs have not finished")


def test_the_share_of_a_measured_curve_counts_moments_of_the_runs_only():
    time = np.array([0.0, 1.0])
    band = Band("a.gap", time, np.zeros(2), np.full(2, 0.5), np.array([1.0, 2.0]))
    curve = MeasuredBand(band, np.array([0.0, 0.5, 1.0, 9.0]), np.array([0.5, 1.6, 1.9, 0.0]))
    assert curve.share_inside == pytest.approx(2 / 3)
    assert MeasuredBand(band, np.empty(0), np.empty(0)).share_inside is None


def test_the_page_has_ranges_reasons_verdicts_and_what_is_missing(found):
    _, text = found
    for part in ("start", "580 to 620", "made up", "in the band", "outside the band"):
        assert part in text
    assert "hottest: not read" in text
    assert len(re.findall("data:image/png;base64,", text)) == 1
    assert not re.search(r'(src|href)="(?!data:|#)', text), "nothing is loaded from elsewhere"


def test_a_missing_value_without_a_range_is_refused(tmp_path):
    one = RANGES.split("[[ranges]]")[1]
    experiment = unknown(tmp_path / "lumped", f"[[ranges]]{one}")
    with pytest.raises(CaseError, match=r"1 missing values .*\n.*boundaries\[0\].*: missing: h"):
        refuse_without_ranges(experiment)


def test_measured_curves_that_are_missing_are_left_out(tmp_path):
    experiment = unknown(tmp_path / "lumped")
    assert overrides_of(experiment)[0] == "bodies.0.temperature=600.0"
    assert "measurements=[]" not in overrides_of(experiment)
    case = experiment.folder / "case.toml"
    case.write_text(case.read_text().replace('"logger.csv"', '"missing: a curve"'))
    assert overrides_of(read_experiment(experiment.folder))[-1] == "measurements=[]"
