"""A measured case as a model: samples of its sensors for values of its unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import load_case
from castx.errors import CaseError, ConvergenceError
from castx.foundry.identification.fit import Unknown
from castx.results.files.series import read_series
from castx.studies.asked.identify import Identify
from castx.studies.inverse.parameters import Parameters
from castx.studies.inverse.sensors import Sensors
from castx.studies.runs.kept import KeptRun
from castx.studies.runs.runner import Changes, Runner

SPARE = {"output": {"fields": ["temperature"]}}
"""What runs do without: only their probes are read."""


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
        parameters = Parameters.of(study.unknowns, case.content)
        parameters.refuse_unusable(runner, case.content)
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
                f"the run with the start of all unknowns is {run.ended}: {run.said}; give another "
                f"start (its log: {self.runner.folder / run.folder})"
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

    def _or_here(self, values: Mapping[str, float], here: FloatArray) -> FloatArray:
        try:
            return self(values)
        except ConvergenceError:  # the fit tries the other side
            return here + self.sensors.noise
