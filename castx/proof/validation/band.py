"""Bands: an experiment whose unknown digits vary over stated ranges, and what was measured of it.

Digits that nobody could read are not invented: each is drawn from the range that the experiment
states for it, with its reason, by a Latin hypercube (M. D. McKay, R. J. Beckman, W. J. Conover,
Technometrics 21 (1979) 239). What was measured lies in the band of the runs, or the model and all
that is known contradict it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import case_data
from castx.errors import CaseError
from castx.input.problems import dotted
from castx.input.units import converted
from castx.proof.validation.experiment import CASE, Experiment, MeasuredAnswer, missing_texts
from castx.results.files.run_tables import RunTables
from castx.studies.asked.known import changes_of_case
from castx.studies.asked.vary import Vary
from castx.studies.runs.curves import Band, curve_bands
from castx.studies.runs.executor import Executor
from castx.studies.runs.kept import KeptRun
from castx.studies.runs.runner import Runner, changes_as_overrides
from castx.studies.vary import refuse_unusable, sampled

WIDE = 2.0
"""Ratio of the ends of a band from which a digit inside it proves little."""
WITHOUT_MEASURED_CURVES = "measurements=[]"


@dataclass(frozen=True)
class AnswerBand:
    """A number of all runs beside the digit that was measured.

    Attributes:
        name: of the digit.
        unit: of the digit.
        lowest: of all runs.
        highest: of all runs.
        measured: the digit; None: it is missing.
        uncertainty: of it in the unit, 0 where it is not stated.
        unfinished: runs whose numbers the band lacks.
    """

    name: str
    unit: str
    lowest: float
    highest: float
    measured: float | None
    uncertainty: float
    unfinished: int = 0

    @property
    def inside(self) -> bool | None:
        """Whether the digit, with its uncertainty, meets the band; None: it is missing."""
        if self.measured is None:
            return None
        least, most = self.measured - self.uncertainty, self.measured + self.uncertainty
        return most >= self.lowest and least <= self.highest

    @property
    def verdict(self) -> str:
        """The measured digit and where it lies, in words."""
        if self.measured is None:
            return "not decidable, no digit was read to compare with"
        given = f" ± {self.uncertainty:.3g}" if self.uncertainty else ""
        where = "in the band" if self.inside else "outside the band"
        if self.unfinished and not self.inside:
            where += f", not decidable while {self.unfinished} runs have not finished"
        return f"measured {self.measured:.4g}{given} {self.unit}: {where}{self._width}"

    @property
    def _width(self) -> str:
        """Words on the width of a wide band; "" of a narrow one."""
        ends = sorted((abs(self.lowest), abs(self.highest)))
        spans_zero = self.lowest <= 0.0 <= self.highest
        if not self.inside or (not spans_zero and ends[1] <= WIDE * ends[0]):
            return ""
        if spans_zero:
            return ", which spans zero: proves little"
        return f", whose ends differ by a factor of {ends[1] / ends[0]:.2g}: proves little"


@dataclass(frozen=True, eq=False)
class MeasuredBand:
    """A band of curves, and the measured curve that belongs to it.

    Attributes:
        band: of the runs.
        time: of the measured curve, (samples,) [s]; empty without one.
        values: of the measured curve, (samples,).
    """

    band: Band
    time: FloatArray
    values: FloatArray

    @property
    def share_inside(self) -> float | None:
        """Share of the measured moments in the band of 5 to 95 %; None without any."""
        at = (self.time >= self.band.time[0]) & (self.time <= self.band.time[-1])
        if not at.any():
            return None
        low, high = (
            np.interp(self.time[at], self.band.time, edge)
            for edge in (self.band.low, self.band.high)
        )
        return float(np.mean((self.values[at] >= low) & (self.values[at] <= high)))


@dataclass(frozen=True, eq=False)
class BandedExperiment:
    """An experiment over its ranges.

    Attributes:
        runs: all, finished or not.
        answers: numbers beside measured digits.
        curves: of the probes.
    """

    runs: Sequence[KeptRun]
    answers: Sequence[AnswerBand]
    curves: Sequence[MeasuredBand]

    @property
    def finished(self) -> int:
        """How many runs have finished."""
        return sum(run.is_finished for run in self.runs)


def refuse_without_ranges(experiment: Experiment) -> None:
    """Refuse to vary an experiment some of whose missing values have no range.

    Raises:
        CaseError: with all of them.
    """
    ranges = {one.of for one in experiment.facts.ranges}
    bare = [
        f"{CASE}: {dotted(path)}: {text}"
        for path, text in missing_texts(experiment.case)
        if path[0] != "measurements" and overridden(path) not in ranges
    ]
    if bare:
        lines = "\n  ".join(bare)
        raise CaseError(
            f"{experiment.folder}: {len(bare)} missing values have no range in [[ranges]], and "
            f"none is invented:\n  {lines}"
        )


def overridden(path: Sequence[str | int]) -> str:
    """Return a path of the case file as `--set` takes it."""
    return ".".join(str(part) for part in path)


def overrides_of(experiment: Experiment) -> list[str]:
    """Return the middle of each range, in place of missing values, as `--set` takes it.

    Measured curves whose file is missing are left out.
    """
    given = changes_as_overrides({one.of: one.level(0.5) for one in experiment.facts.ranges})
    lacks = any(path[0] == "measurements" for path, _ in missing_texts(experiment.case))
    return [*given, WITHOUT_MEASURED_CURVES] if lacks else given


def banded(experiment: Experiment, folder: Path, executor: Executor) -> BandedExperiment:
    """Run the case of an experiment over its ranges, and lay what was measured beside it.

    Args:
        experiment: with a range for each missing value of its case.
        folder: of the study, locked.
        executor: makes the runs.

    Raises:
        CaseError: a missing value has no range, the case refuses one, or no run has finished.
    """
    refuse_without_ranges(experiment)
    study = Vary(draws=experiment.facts.draws, inputs=experiment.facts.ranges)
    case_file, given = experiment.folder / CASE, overrides_of(experiment)
    refuse_unusable(case_file, given, study.inputs, "ranges")
    runner = Runner(case_file, given, folder, executor)
    _, values = sampled(study)
    data, _ = case_data(case_file, given)
    runs = runner.runs([changes_of_case(data, study.inputs, row) for row in values])
    tables = [RunTables(runner.results(run)) for run in runs if run.is_finished]
    if not tables:
        raise CaseError(f"not one of {len(runs)} runs has finished; the first one: {runs[0].said}")
    missing = len(runs) - len(tables)
    answers = [answer_band(experiment, one, tables, missing) for one in experiment.facts.answers]
    return BandedExperiment(runs, answers, [beside(b, tables[0]) for b in curve_bands(tables)])


def answer_band(
    experiment: Experiment, asked: MeasuredAnswer, runs: Sequence[RunTables], unfinished: int
) -> AnswerBand:
    """Return a number of all runs beside its digit.

    Args:
        experiment: that has the digit.
        asked: which digit, and how a run answers it.
        runs: finished ones, at least one.
        unfinished: how many others there are.
    """
    digit = next(digit for digit in experiment.facts.digits if digit.name == asked.digit)
    unit = asked.unit_of(runs[0])
    found = [asked.of_run(run) for run in runs]
    lowest, highest = (converted(value, unit, digit.unit) for value in (min(found), max(found)))
    measured = None if isinstance(digit.value, str) else digit.value
    uncertainty = 0.0 if isinstance(digit.uncertainty, str) else digit.uncertainty
    return AnswerBand(digit.name, digit.unit, lowest, highest, measured, uncertainty, unfinished)


def beside(band: Band, run: RunTables) -> MeasuredBand:
    """Return a band with the measured curve of the same column, if there is one."""
    found = run.measured.get(band.column)
    none = np.empty(0)
    return MeasuredBand(band, found.time if found else none, found.values if found else none)
