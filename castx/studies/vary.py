"""A study that varies numbers of a case: its runs, their table, and what matters."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import case_data, load_case
from castx.errors import CaseError
from castx.results.files.folder import store_text
from castx.results.files.run_tables import RunTables
from castx.studies.asked.amounts import amount
from castx.studies.asked.inputs import VariedInput
from castx.studies.asked.known import changes_of_case, refuse_elsewhere
from castx.studies.asked.units_of_case import shown_unit
from castx.studies.asked.vary import GRID, LATIN, MORRIS, Vary
from castx.studies.importance import Importance, importance
from castx.studies.page import vary_page
from castx.studies.runs.answers import answers
from castx.studies.runs.curves import Band, curve_bands
from castx.studies.runs.runner import Runner, changes_as_overrides
from castx.studies.sampling import grid, latin_hypercube, morris_paths, saltelli_points
from castx.studies.table import StudyTable

TABLE, STUDY, PAGE = "table.csv", "study.json", "vary.html"


@dataclass(frozen=True, eq=False)
class VariedCase:
    """A study that has ended.

    Attributes:
        table: its runs.
        importance: of the answers that vary.
        bands: of the curves of the probes; none if no run has finished.
    """

    table: StudyTable
    importance: Sequence[Importance]
    bands: Sequence[Band]


def sampled(study: Vary) -> tuple[FloatArray, list[list[float | str]]]:
    """Return points of the unit cube, (runs, inputs), and the values there as a case writes them.

    Of a grid with given values the points lie evenly, in the order of the values.
    """
    inputs = study.inputs
    if study.method == GRID:
        points = grid([_even(_levels(one)) for one in inputs])
    elif study.method == LATIN:
        points = latin_hypercube(len(inputs), study.number_of_draws, study.seed)
    elif study.method == MORRIS:
        points = morris_paths(len(inputs), study.number_of_draws, study.seed)
    else:
        points = saltelli_points(len(inputs), study.number_of_draws, study.seed)
    values = [[_value(one, u) for one, u in zip(inputs, point, strict=True)] for point in points]
    return points, values


def _even(levels: int) -> FloatArray:
    return np.asarray(np.linspace(0.0, 1.0, levels), dtype=np.float64)


def _levels(one: VariedInput) -> int:
    return len(one.values) if one.values is not None else one.points


def _value(one: VariedInput, share: float) -> float | str:
    if one.values is None:
        return one.level(share)
    chosen = one.values[round(share * (len(one.values) - 1))]
    return chosen.written(chosen.value)


def refuse_unusable(
    case_file: Path, overrides: Sequence[str], inputs: Sequence[VariedInput], kind: str
) -> None:
    """Refuse inputs that the case does not take, at an end of their range or with one of values.

    Args:
        case_file: the case.
        overrides: values that replace those of the file.
        inputs: what is varied.
        kind: the table of the study.

    Raises:
        CaseError: with path, value and what the case asks for.
    """
    load_case(case_file, overrides)
    data, _ = case_data(case_file, overrides)
    for one in inputs:
        for share in (0.0, 1.0) if one.values is None else _even(len(one.values)):
            try:
                refuse_elsewhere(data, one.of)
                changes = changes_of_case(data, [one], [_value(one, float(share))])
                load_case(case_file, [*overrides, *changes_as_overrides(changes)])
            except CaseError as error:
                raise CaseError(f"[{kind}] {one.label}: {error}") from None


def vary(runner: Runner, study: Vary) -> VariedCase:
    """Make the runs of a study, and write their table, study.json and vary.html into its folder.

    Args:
        runner: of the case.
        study: what is varied.

    Raises:
        CaseError: an input does not suit the case, or not one run has finished.
    """
    refuse_unusable(runner.case_file, runner.overrides, study.inputs, "vary")
    points, values = sampled(study)
    data, _ = case_data(runner.case_file, runner.overrides)
    runs = runner.runs([changes_of_case(data, study.inputs, row) for row in values])
    finished = [run for run in runs if run.is_finished]
    if not finished:
        raise CaseError(f"not one of {len(runs)} runs has finished; the first one: {runs[0].said}")
    table = StudyTable(
        [one.label for one in study.inputs],
        [shown_unit(data, one) for one in study.inputs],
        np.array([[amount(value).value for value in row] for row in values]),
        runs,
        [answers(runner.results(run)) if run.is_finished else {} for run in runs],
    )
    bands = curve_bands([RunTables(runner.results(run)) for run in finished])
    found = VariedCase(table, importance(table, points, study.method), bands)
    store_text(runner.folder / TABLE, table.text())
    text = json.dumps(as_json(found, study), indent=2, ensure_ascii=False, allow_nan=False)
    store_text(runner.folder / STUDY, text + "\n")
    store_text(
        runner.folder / PAGE,
        vary_page(runner.case_file.stem, study, table, found.importance, bands),
    )
    return found


def as_json(found: VariedCase, study: Vary) -> dict[str, Any]:
    """Return a study with the types of JSON."""
    table = found.table
    return {
        "method": study.method,
        "seed": study.seed,
        "inputs": list(table.inputs),
        "units": list(table.units),
        "runs": [
            {
                "folder": run.folder,
                "ended": run.ended,
                "said": run.said,
                "seconds": run.seconds,
                "processor_seconds": run.processor_seconds,
                "inputs": [float(value) for value in table.values[index]],
                "answers": {name: one.shown for name, one in table.found[index].items()},
            }
            for index, run in enumerate(table.runs)
        ],
        "what matters": [one.as_json() for one in found.importance],
    }
