"""The table of a study: a line for each run, with its inputs and its answers."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.studies.runs.answers import RunAnswer
from castx.studies.runs.kept import KeptRun


@dataclass(frozen=True, eq=False)
class StudyTable:
    """Runs with their inputs and answers.

    Attributes:
        inputs: names of the inputs.
        units: theirs, "" if plain.
        values: of the inputs, (runs, inputs), each in its unit.
        runs: how they have ended.
        found: answers of each run by name; none of those that have failed.
    """

    inputs: Sequence[str]
    units: Sequence[str]
    values: FloatArray
    runs: Sequence[KeptRun]
    found: Sequence[Mapping[str, RunAnswer]]

    @property
    def outputs(self) -> list[str]:
        """Names of all answers, in the order of their first appearance."""
        return list(dict.fromkeys(name for answers in self.found for name in answers))

    def unit(self, output: str) -> str:
        """Return the unit in which an answer is shown."""
        return next(answers[output].unit for answers in self.found if output in answers)

    def result(self, output: str) -> FloatArray:
        """Return an answer of all runs in its unit, NaN where there is none, (runs,)."""
        return np.array(
            [answers[output].shown if output in answers else np.nan for answers in self.found]
        )

    def varied(self) -> list[str]:
        """Return the answers on the casting that differ between runs by more than round-off."""
        chosen = []
        for name in self.outputs:
            if any(answers[name].of_mesh for answers in self.found if name in answers):
                continue
            known = self.result(name)
            known = known[np.isfinite(known)]
            if len(known) > 1 and np.ptp(known) > 1e-9 * np.max(np.abs(known)):
                chosen.append(name)
        return chosen

    def text(self) -> str:
        """Return the table as CSV."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        heads = [with_unit(name, unit) for name, unit in zip(self.inputs, self.units, strict=True)]
        heads += [with_unit(name, self.unit(name)) for name in self.outputs]
        writer.writerow(["folder", "ended", *heads])
        results = [self.result(name) for name in self.outputs]
        for index, run in enumerate(self.runs):
            cells = [f"{value:.9g}" for value in self.values[index]]
            cells += ["" if np.isnan(of[index]) else f"{of[index]:.9g}" for of in results]
            writer.writerow([run.folder, run.ended, *cells])
        return text.getvalue()


def with_unit(name: str, unit: str) -> str:
    """Return a heading."""
    return f"{name} [{unit}]" if unit else name
