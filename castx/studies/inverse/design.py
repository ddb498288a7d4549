"""Where the next thermocouple belongs: D- and A-optimal choice of candidate places by runs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.reading.read import load_case
from castx.errors import CaseError, ConvergenceError
from castx.foundry.identification.covariance import deviations
from castx.foundry.identification.fit import Unknown
from castx.foundry.identification.sensors import Candidate, a_optimal, d_optimal
from castx.input.problems import among
from castx.results.files.folder import store_text
from castx.results.files.series import read_series
from castx.studies.asked.candidates import CandidateSensor
from castx.studies.asked.identify import Identify
from castx.studies.inverse.estimates import prior_covariance
from castx.studies.inverse.model import SPARE, usable_unknowns
from castx.studies.inverse.parameters import Parameters
from castx.studies.runs.runner import Runner

SHIFT = 1e-4
"""Difference of depths [m]."""
RESULT = "design.json"


@dataclass(frozen=True, eq=False)
class Chosen:
    """A place in the order of choice.

    Attributes:
        name: of the place.
        deviations: of all numbers once it is taken with those before, (numbers,).
    """

    name: str
    deviations: FloatArray


@dataclass(frozen=True, eq=False)
class SensorDesign:
    """Places for the next sensors.

    Attributes:
        numbers: names of the numbers that shall be told.
        before: their deviations with the sensors that are there, (numbers,).
        d_order: the choice that lowers the volume of what is not known most.
        a_order: the one that lowers the sum of the variances of the wanted numbers most.
        runs: that its slopes took, those of the start included.
    """

    numbers: Sequence[str]
    before: FloatArray
    d_order: Sequence[Chosen]
    a_order: Sequence[Chosen]
    runs: int


def design(runner: Runner, study: Identify) -> SensorDesign:
    """Return the order in which candidates should be taken, and write design.json.

    Slopes are those at the start of the unknowns. Sensors of the curves count as there already.

    Args:
        runner: of the case.
        study: with candidates.

    Raises:
        CaseError: there are no candidates, or unknowns do not suit the case.
        ConvergenceError: a run fails.
    """
    if not study.candidates:
        raise CaseError("--design needs [[identify.candidates]]: places where a sensor might lie")
    case = load_case(runner.case_file, runner.overrides)
    parameters = usable_unknowns(runner.case_file, runner.overrides, study, case)
    unknowns = parameters.unknowns()
    present = present_sensors(study, case)
    tables = slope_tables(runner, parameters, unknowns, [*study.candidates, *present])
    time = np.asarray(np.arange(study.every, case.time.end, study.every), dtype=np.float64)
    candidates = {one.name: with_slopes(one, tables, unknowns, time) for one in study.candidates}
    there = [with_slopes(one, tables, unknowns, time) for one in present]
    smooth = parameters.smoothness(len(unknowns))
    told = np.linalg.inv(prior_covariance(unknowns, smooth))
    told = told + sum((one.information() for one in there), np.zeros_like(told))
    prior = np.asarray(np.linalg.inv(told))
    found = _ordered(candidates, prior, unknowns, study)
    store_text(runner.folder / RESULT, json.dumps(_json(found), indent=2) + "\n")
    return found


def _ordered(
    candidates: dict[str, Candidate],
    prior: FloatArray,
    unknowns: Sequence[Unknown],
    study: Identify,
) -> SensorDesign:
    names = [unknown.name for unknown in unknowns]
    groups = {
        one.name: [name for name in names if name.partition(" at ")[0] == one.name]
        for one in study.unknowns
    }
    wanted = [name for of in (study.wanted or tuple(groups)) for name in groups[of]]
    number = min(study.sensors, len(candidates))
    listed = list(candidates.values())
    columns = [names.index(name) for name in wanted]

    def with_deviations(order: Sequence[str]) -> list[Chosen]:
        told, chosen = np.linalg.inv(prior), []
        for name in order:
            told = told + candidates[name].information()
            chosen.append(Chosen(name, deviations(np.asarray(np.linalg.inv(told)))))
        return chosen

    return SensorDesign(
        names,
        deviations(prior),
        with_deviations(d_optimal(listed, number, prior)),
        with_deviations(a_optimal(listed, number, prior, columns)),
        1 + len(unknowns),
    )


def present_sensors(study: Identify, case: Case) -> list[CandidateSensor]:
    """Return the thermocouples that are there already.

    Raises:
        CaseError: no probe belongs to a curve.
    """
    own = {one.name: one for one in case.probes}
    found = []
    for k, curve in enumerate(study.curves):
        if curve.probe not in own:
            raise CaseError(
                f"[identify] {curve.of}: {among(curve.probe, list(own), what='probes')}"
            )
        probe = own[curve.probe]
        if curve.of == f"{probe.name}.temperature":
            kept = {key: getattr(probe, key) for key in ("body", "below", "depth", "at")}
            more = {"noise": curve.sigma, "depth_deviation": curve.depth_deviation or 0.0}
            given = {"name": f"sensor {k}", **kept, "direction": curve.direction, **more}
            found.append(CandidateSensor.read(given))
    return found


def slope_tables(
    runner: Runner,
    parameters: Parameters,
    unknowns: Sequence[Unknown],
    places: Sequence[CandidateSensor],
) -> list[dict[str, FloatArray]]:
    """Return the curves at the start, and with each number moved by its difference.

    Args:
        runner: of the case.
        parameters: unknowns of the case.
        unknowns: their numbers.
        places: sensors.

    Raises:
        ConvergenceError: a run fails.
    """
    start = {one.name: one.value(one.first) for one in unknowns}
    moved = [start] + [
        {**start, one.name: one.value(one.first + one.difference)} for one in unknowns
    ]
    probes = [row for one in places for row in one.probes(SHIFT)]
    runs = runner.runs(
        [{**SPARE, "probes": probes, **parameters.changes(values)} for values in moved]
    )
    for run in runs:
        if not run.is_finished:
            raise ConvergenceError(f"a run of the design is {run.ended}: {run.said}")
    return [read_series(runner.results(run) / "probes.csv") for run in runs]


def with_slopes(
    place: CandidateSensor,
    tables: Sequence[Mapping[str, FloatArray]],
    unknowns: Sequence[Unknown],
    time: FloatArray,
) -> Candidate:
    """Return a place with the slopes of its samples.

    Args:
        place: the place.
        tables: curves at the start, and with each number moved by its difference.
        unknowns: the numbers.
        time: of the samples [s], (samples,).
    """

    def samples(table: Mapping[str, FloatArray], of: str) -> FloatArray:
        return np.asarray(np.interp(time, table["time"], table[f"{of}.temperature"]))

    here = samples(tables[0], place.name)
    slopes = [
        (samples(table, place.name) - here) / unknown.difference
        for table, unknown in zip(tables[1:], unknowns, strict=True)
    ]
    by_depth = np.asarray((samples(tables[0], f"{place.name} deeper") - here) / SHIFT)
    deviation = place.depth_deviation
    return Candidate(
        place.name, np.asarray(np.column_stack(slopes)), by_depth, np.array(place.noise), deviation
    )


def _json(found: SensorDesign) -> dict[str, object]:
    def rows(order: Sequence[Chosen]) -> list[dict[str, object]]:
        return [{"name": one.name, "deviations": one.deviations.tolist()} for one in order]

    return {
        "numbers": list(found.numbers),
        "before": found.before.tolist(),
        "d_optimal": rows(found.d_order),
        "a_optimal": rows(found.a_order),
    }
