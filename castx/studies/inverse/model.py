"""A measured case as a model: samples of its sensors for values of its unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.reading.read import load_case
from castx.errors import CaseError, ConvergenceError
from castx.foundry.identification.fit import Unknown
from castx.results.files.series import read_series
from castx.studies.asked.identify import Identify
from castx.studies.inverse.parameters import Parameters
from castx.studies.inverse.sensors import Sensors
from castx.studies.runs.kept import (
    BROKEN,
    LOG,
    NOT_CONVERGED,
    OUT_OF_TIME,
    REFUSED,
    KeptRun,
)
from castx.studies.runs.runner import Changes, Runner

CURES = {
    NOT_CONVERGED: "give another start",
    REFUSED: "correct the case",
    OUT_OF_TIME: "raise time_limit, or time of slurm, and start with --anew",
    BROKEN: "see what it lacked, and start with --anew",
}
"""What helps where the run of the start has ended so."""
SPARE = {"output": {"fields": ["temperature"]}}
"""What runs do without: only their probes are read."""


def usable_unknowns(
    case_file: Path, overrides: Sequence[str], study: Identify, case: Case
) -> Parameters:
    """Return the unknowns of a study.

    Args:
        case_file: the case.
        overrides: values that replace those of the file.
        study: what is sought.
        case: as it was read from them.

    Raises:
        CaseError: the case does not have or take them.
    """
    found = Parameters.of(study.unknowns, case.content)
    found.refuse_unusable(case_file, overrides, case.content)
    return found


def refuse_unidentifiable(case_file: Path, overrides: Sequence[str], study: Identify) -> None:
    """Refuse a study whose curves or unknowns do not suit its case, before anything is run.

    Args:
        case_file: the case.
        overrides: values that replace those of the file.
        study: with the files of its curves beside the case; without curves it is a design.

    Raises:
        CaseError: with path, value and cure.
    """
    case = load_case(case_file, overrides)
    if study.curves:
        Sensors.of(study, case)
    usable_unknowns(case_file, overrides, study, case)


@dataclass(frozen=True, eq=False)
class MeasuredCase:
    """A case whose runs are compared with samples.

    Attributes:
        runner: of the case.
        parameters: unknowns of the case.
        sensors: with their samples.
        probes: of each run.
    """

    runner: Runner
    parameters: Parameters
    sensors: Sensors
    probes: Changes

    @classmethod
    def of(cls, runner: Runner, study: Identify) -> MeasuredCase:
        """Return the model of a study.

        Raises:
            CaseError: the samples or the unknowns do not suit the case.
        """
        case = load_case(runner.case_file, runner.overrides)
        sensors = Sensors.of(study, case)
        given = case.content.get("probes", [])
        parameters = usable_unknowns(runner.case_file, runner.overrides, study, case)
        return cls(runner, parameters, sensors, {"probes": sensors.probes(given)})

    def unknowns(self) -> list[Unknown]:
        """Return all numbers of the fit, those of the case first."""
        return [*self.parameters.unknowns(), *self.sensors.unknowns()]

    def names(self) -> list[str]:
        """Return the names of all numbers of the fit."""
        return [unknown.name for unknown in self.unknowns()]

    def changes(self, values: Mapping[str, float]) -> Changes:
        """Return the changes of the case; depths and clock change nothing in a run."""
        return {**SPARE, **self.probes, **self.parameters.changes(values)}

    def ahead(self, several: Sequence[Mapping[str, float]]) -> None:
        """Make the runs of several values at once."""
        self.runner.runs([self.changes(values) for values in several])

    def run(self, values: Mapping[str, float]) -> KeptRun:
        """Return the run of some values."""
        return self.runner.runs([self.changes(values)])[0]

    def columns(self, values: Mapping[str, float]) -> dict[str, FloatArray]:
        """Return the columns of probes.csv of the run of some values.

        Raises:
            ConvergenceError: the run has failed, or the case does not take the values.
        """
        run = self.run(values)
        if not run.is_finished:
            raise ConvergenceError(f"{run.ended}: {run.said}")
        return read_series(self.runner.results(run) / "probes.csv")

    def __call__(self, values: Mapping[str, float]) -> FloatArray:
        """Return the samples of all sensors, (samples,)."""
        return self.sensors.computed(self.columns(values), values)

    def several(self, asked: Sequence[Mapping[str, float]]) -> list[FloatArray | None]:
        """Return the samples of several values, whose runs go on at once; None of failed runs."""
        self.ahead(asked)
        found: list[FloatArray | None] = []
        for values in asked:
            try:
                found.append(self(values))
            except ConvergenceError:
                found.append(None)
        return found

    def refuse_bad_start(self) -> None:
        """Make the run of the start, and those of its slopes, and refuse what they do not tell.

        Raises:
            CaseError: the run fails, or an unknown of which nothing is known before changes no
                sample.
        """
        unknowns = self.unknowns()
        start = {unknown.name: unknown.value(unknown.first) for unknown in unknowns}
        run = self.run(start)
        if not run.is_finished:
            raise CaseError(
                f"the run with the start of all unknowns is {run.ended}: {run.said}; "
                f"{self._cure(run)} (its log: {self.runner.folder / run.folder / LOG})"
            )
        moved = [
            {**start, unknown.name: unknown.value(unknown.first + unknown.difference)}
            for unknown in unknowns
        ]
        self.ahead(moved)
        smooth = self.parameters.smoothness(len(unknowns))
        held = np.zeros(len(unknowns)) if smooth is None else np.abs(smooth).sum(axis=0)
        here = self(start)
        for unknown, values, by_others in zip(unknowns, moved, held, strict=True):
            if np.isfinite(unknown.deviation) or by_others > 0.0:
                continue
            if np.max(np.abs(self._or_here(values, here) - here) / self.sensors.noise) < 1e-9:
                raise CaseError(
                    f"[identify] {unknown.name} has no influence on any sample: leave it out, or "
                    "say how well it is known with deviation"
                )

    def _cure(self, run: KeptRun) -> str:
        """Return the cure for the failed run of the start."""
        sensor = self.sensors.with_rung_in(run.said) if run.ended == REFUSED else None
        if sensor is None:
            return CURES[run.ended]
        far = 1e3 * float(sensor.rungs[-1])
        return (
            f"the place of {sensor.probe.name} may be off by three depth_deviations, {far:g} mm, "
            "and lies in its body only with a smaller one, or elsewhere"
        )

    def _or_here(self, values: Mapping[str, float], here: FloatArray) -> FloatArray:
        try:
            return self(values)
        except ConvergenceError:  # the fit tries the other side
            return here + self.sensors.noise
