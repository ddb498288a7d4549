"""A study that looks for the best numbers of a case, without slopes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.optimize import Bounds, differential_evolution, minimize

from castx.arrays import FloatArray
from castx.case.reading.read import case_data
from castx.errors import CaseError
from castx.input.problems import among
from castx.input.toml_written import toml_text
from castx.results.files.folder import store_text
from castx.studies.asked.amounts import amount
from castx.studies.asked.optimise import EVOLUTION, LEAST, Optimise
from castx.studies.asked.units_of_case import shown_unit
from castx.studies.optimised_page import optimised_page
from castx.studies.runs.answers import RunAnswer, answers
from castx.studies.runs.case_text import changed_content
from castx.studies.runs.kept import KeptRun
from castx.studies.runs.runner import Changes, Runner
from castx.studies.table import StudyTable
from castx.studies.vary import TABLE, refuse_unusable

RESULT, PAGE = "optimised.json", "optimised.html"
HEAD = "# With the best numbers that castx optimise has found.\n\n"
FORBIDDEN = 1e30
"""Cost of a run beyond a limit; it grows with the excess, so that limits are met first."""
NEAR = 1e-3
"""Share of a range below which a simplex has closed."""


class _Enough(Exception):
    """All runs are spent, or nothing can come of them; SciPy would catch a `ValueError`."""


@dataclass
class _Trials:
    """All runs of a study in the order in which they were asked for."""

    runner: Runner
    study: Optimise
    points: list[FloatArray] = field(default_factory=list)
    runs: list[KeptRun] = field(default_factory=list)
    found: list[dict[str, RunAnswer]] = field(default_factory=list)
    costs: list[float] = field(default_factory=list)
    refusal: str = ""

    def changes(self, point: FloatArray) -> Changes:
        """Return the changes of the case at a point of the unit cube."""
        pairs = zip(self.study.inputs, np.clip(point, 0.0, 1.0), strict=True)
        return {one.of: one.level(float(share)) for one, share in pairs}

    def cost(self, points: Sequence[FloatArray]) -> list[float]:
        """Return the costs of points, whose runs go on at once."""
        if len(self.runs) + len(points) > self.study.runs:
            raise _Enough
        runs = self.runner.runs([self.changes(point) for point in points])
        found = [answers(self.runner.results(r)) if r.is_finished else {} for r in runs]
        self.points += list(points)
        self.runs += runs
        self.found += found
        self.refusal = self.unknown_answers()
        if self.refusal:
            raise _Enough
        costs = [cost_of(one, self.study) for one in found]
        self.costs += costs
        return costs

    def unknown_answers(self) -> str:
        """Return the refusal of a name that no run has answered, once runs have finished, or ""."""
        known = list(dict.fromkeys(name for one in self.found for name in one))
        for name in (self.study.goal, *(limit.of for limit in self.study.limits)):
            if known and name not in known:
                return f"[optimise] no run has answered {name!r}; {among(name, known)}"
        return ""


def cost_of(found: dict[str, RunAnswer], study: Optimise) -> float:
    """Return the cost of a run: the goal, within limits; infinite where an answer is missing.

    Args:
        found: answers of a run.
        study: the study.
    """
    names = [study.goal, *(limit.of for limit in study.limits)]
    if any(name not in found for name in names):
        return np.inf
    excess = sum(limit.excess(found[limit.of].shown) for limit in study.limits)
    if excess > 0.0:
        return FORBIDDEN * (1.0 + excess)
    value = found[study.goal].shown
    return value if study.direction == LEAST else -value


@dataclass(frozen=True, eq=False)
class Optimised:
    """The best run of a study.

    Attributes:
        table: all runs.
        best: the index of the best one.
        within: whether it keeps all limits.
        case_file: the case with its numbers.
        spent: whether the search ended because all its runs were spent.
    """

    table: StudyTable
    best: int
    within: bool
    case_file: Path
    spent: bool

    @property
    def remarks(self) -> list[str]:
        """Remarks on the best run, in words."""
        found = [] if self.within else ["No run keeps all limits; this one is nearest."]
        if self.spent:
            found.append(
                f"The search had not settled when its {len(self.table.runs)} runs were spent: more "
                "(runs) go on from there, and may find better numbers."
            )
        return found


def optimise(runner: Runner, study: Optimise) -> Optimised:
    """Look for the best numbers, and write the table of all runs and the case with the best ones.

    Args:
        runner: of the case.
        study: what is best.

    Raises:
        CaseError: an input does not suit the case, an answer is none, or no run has all answers.
    """
    refuse_unusable(runner.case_file, runner.overrides, study.inputs, "optimise")
    trials = _Trials(runner, study)
    spent = False
    try:
        _evolve(trials) if study.method == EVOLUTION else _fold(trials)
    except _Enough:
        spent = True
        if trials.refusal:
            raise CaseError(trials.refusal) from None
    if not np.isfinite(trials.costs).any():
        why = next((run.said for run in trials.runs if run.said), "no answer to the goal")
        raise CaseError(
            f"[optimise] not one of {len(trials.runs)} runs has answered {study.goal!r}: {why}"
        )
    best = int(np.argmin(trials.costs))
    values = [trials.changes(point) for point in trials.points]
    data, _ = case_data(runner.case_file, runner.overrides)
    table = StudyTable(
        [one.label for one in study.inputs],
        [shown_unit(data, one) for one in study.inputs],
        np.array([[amount(row[one.of]).value for one in study.inputs] for row in values]),
        trials.runs,
        trials.found,
    )
    case_file = runner.case_file.with_suffix(".optimised.toml")
    found = Optimised(table, best, trials.costs[best] < FORBIDDEN, case_file, spent)
    store_text(runner.folder / TABLE, table.text())
    content = changed_content(runner.case_file, runner.overrides, values[best])
    store_text(case_file, HEAD + toml_text(content))
    store_text(runner.folder / RESULT, json.dumps(_json(found, study), indent=2) + "\n")
    within = np.array(trials.costs) < FORBIDDEN
    name = runner.case_file.stem
    page = optimised_page(name, study, table, within, best, found.remarks)
    store_text(runner.folder / PAGE, page)
    return found


def _evolve(trials: _Trials) -> None:
    numbers = len(trials.study.inputs)
    population = trials.study.population

    def costs(points: FloatArray) -> FloatArray:
        return np.array(trials.cost(list(np.asarray(points).T)))

    differential_evolution(
        costs, Bounds(np.zeros(numbers), np.ones(numbers)), maxiter=trials.study.runs,
        init=np.random.default_rng(trials.study.seed).random((population, numbers)),
        seed=np.random.default_rng(trials.study.seed), polish=False, vectorized=True,
        updating="deferred",
    )  # fmt: skip


def _fold(trials: _Trials) -> None:
    numbers = len(trials.study.inputs)
    middle = np.full(numbers, 0.5)
    simplex = np.vstack([middle, middle + 0.25 * np.eye(numbers)])

    def cost(point: FloatArray) -> float:
        if np.any((point < 0.0) | (point > 1.0)):  # clipped, a simplex would fall flat there
            return np.inf
        return trials.cost([np.asarray(point)])[0]

    options = {"initial_simplex": simplex, "xatol": NEAR, "fatol": np.inf}
    minimize(cost, middle, method="Nelder-Mead", options=options)


def _json(found: Optimised, study: Optimise) -> dict[str, object]:
    table = found.table
    values = zip(table.inputs, table.values[found.best], strict=True)
    return {
        "goal": study.goal,
        "within limits": found.within,
        "inputs": {name: float(value) for name, value in values},
        "answers": {name: one.shown for name, one in table.found[found.best].items()},
        "folder": table.runs[found.best].folder,
        "runs": len(table.runs),
    }
