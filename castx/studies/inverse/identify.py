"""A study that identifies numbers of a case from measured curves."""

from __future__ import annotations

import json
import logging
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError, UnsettledFit
from castx.foundry.identification.ensemble import assimilate
from castx.foundry.identification.fit import Fit, fit
from castx.results.files.folder import store_text
from castx.studies.asked.identify import ENSEMBLE, Identify
from castx.studies.inverse.estimates import Estimates, estimates, prior_covariance
from castx.studies.inverse.identified_case import identified_case
from castx.studies.inverse.model import MeasuredCase
from castx.studies.inverse.page import identified_page
from castx.studies.inverse.predictions import Prediction, curve_bands, table_bands
from castx.studies.runs.runner import Runner

REACH = 1.0
"""Largest step of a logarithm: a guess that is far off is left by steps that the model follows."""
NEARER = 0.99
"""Residuals have to fall to this share before they are told again."""
RESULT, PAGE = "identified.json", "identified.html"


log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Identified:
    """Result of a study: numbers that measured curves have told.

    Attributes:
        model: the measured case.
        found: estimates with their uncertainty.
        tables: unknown tables with their bands.
        curves: of the sensors, with their bands.
        case_file: the case with these numbers.
    """

    model: MeasuredCase
    found: Estimates
    tables: Sequence[Prediction]
    curves: Sequence[Prediction]
    case_file: Path


def identify(runner: Runner, study: Identify) -> Identified:
    """Fit the unknowns of a study, and write what was found into its folder and a new case file.

    Args:
        runner: of the case.
        study: what was measured, and what is sought.

    Raises:
        CaseError: samples or unknowns do not suit the case or each other.
        UnsettledFit: the fit does not settle.
    """
    if not study.curves:
        raise CaseError("[identify] has no [[identify.curves]]: nothing was measured")
    model = MeasuredCase.of(runner, study)
    model.refuse_bad_start()
    unknowns = model.unknowns()
    smoothness = model.parameters.smoothness(len(unknowns))
    found = fitted(model, study)
    units = [one.shown_unit for one in model.parameters.sought for _ in one.names]
    units += [_sensor_unit(one.name) for one in unknowns[len(units) :]]
    parts = model.sensors.parts(found.residuals)
    residuals = [
        (one.asked.of, part) for one, part in zip(model.sensors.sensors, parts, strict=True)
    ]
    result = Identified(
        model,
        estimates(found, unknowns, units, model.sensors.noise, smoothness, residuals),
        table_bands(model.parameters.sought, found),
        curve_bands(model.sensors, found),
        runner.case_file.with_suffix(".identified.toml"),
    )
    write(result)
    return result


def _sensor_unit(name: str) -> str:
    return "s" if name == "clock" else "m"


@dataclass
class Told:
    """A measured case that tells how near its runs have come.

    Attributes:
        model: the measured case.
        least: root mean square of the residuals over the noise, the least so far.
    """

    model: MeasuredCase
    least: float = np.inf

    def __call__(self, values: Mapping[str, float]) -> FloatArray:
        """Return the samples of all sensors, (samples,)."""
        samples, sensors = self.model(values), self.model.sensors
        size = float(np.sqrt(np.mean(((sensors.measured - samples) / sensors.noise) ** 2)))
        if size < NEARER * self.least:
            self.least = size
            log.info("the residuals are %.3g times the noise", size)
        return samples


def fitted(model: MeasuredCase, study: Identify) -> Fit:
    """Return the fit of a study by the engine that it names; raises as `identify`."""
    unknowns = model.unknowns()
    if study.engine == ENSEMBLE:
        return assimilated(model, study)
    try:
        return fit(
            Told(model), model.sensors.measured, model.sensors.noise, unknowns,
            model.parameters.smoothness(len(unknowns)), study.tries, model.ahead, REACH,
        )  # fmt: skip
    except ValueError as error:
        raise CaseError(
            f"[identify] {error}: measure what they hang on, leave out knots, say what is known "
            "before (deviation), or hold tables smooth (smoothness)"
        ) from None
    except UnsettledFit as error:
        raise UnsettledFit(
            f"{error}; see its runs in {model.runner.folder}, raise tries, or begin nearer by with "
            "start"
        ) from None


def assimilated(model: MeasuredCase, study: Identify) -> Fit:
    """Return the fit of a study by an ensemble of runs.

    Raises:
        CaseError: there are too few members.
        UnsettledFit: most runs fail.
    """
    unknowns = model.unknowns()
    prior = prior_covariance(unknowns, model.parameters.smoothness(len(unknowns)))
    try:
        return assimilate(
            model.several, model.sensors.measured, model.sensors.noise, unknowns, prior,
            study.members, study.rounds, study.seed,
        )  # fmt: skip
    except ValueError as error:
        raise CaseError(f"[identify] {error}") from None


def write(result: Identified) -> None:
    """Write a result into the folder of its study, and the new case file."""
    folder, model = result.model.runner.folder, result.model
    text = json.dumps(as_json(result), indent=2, ensure_ascii=False, allow_nan=False)
    store_text(folder / RESULT, text + "\n")
    store_text(
        folder / PAGE,
        identified_page(
            model.runner.case_file.stem, result.found, model.sensors, result.tables, result.curves
        ),
    )
    store_text(result.case_file, identified_case(model, result.found.fit.values))


def as_json(result: Identified) -> dict[str, Any]:
    """Return a result with the types of JSON."""
    found = result.found
    numbers = []
    for one in found.estimates:
        row = asdict(one)
        row["known"] = row["known"] if np.isfinite(one.known) else None
        numbers.append(row)
    return {
        "estimates": numbers,
        "covariance": found.fit.covariance.tolist(),
        "chi_square": found.fit.chi_square,
        "whiteness": list(found.whiteness),
        "unseen": list(found.unseen),
        "remarks": list(found.remarks),
        "curves": [
            {
                "name": one.name,
                "argument": one.argument.tolist(),
                "value": one.value.tolist(),
                "low": one.low.tolist(),
                "high": one.high.tolist(),
            }
            for one in (*result.tables, *result.curves)
        ],
    }
