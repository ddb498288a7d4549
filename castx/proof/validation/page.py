"""validation.html: a model over an experiment, curve by curve, in one offline page."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path

import jinja2
import numpy as np

from castx.proof.validation.experiment import Experiment
from castx.report.style import COLOURS, DOTS_PER_INCH, figure
from castx.results.files.folder import write_whole
from castx.results.files.measurements import Deviation
from castx.results.reading import Results
from castx.results.states.quantities import UNITS

PAGE = "validation.html"
MOST_POINTS = 60
"""Of a measured curve that are drawn, about."""


@dataclass(frozen=True)
class Overlay:
    """A computed curve over a measured one.

    Attributes:
        column: of probes.csv.
        deviation: how far they are apart.
        uncertainty: of the measured one in SI units, or "not stated".
        source: of the measured one.
        within: share of the measured moments at which they are apart by less than the uncertainty;
            None where that is not stated.
        picture: PNG.
    """

    column: str
    deviation: Deviation
    uncertainty: float | str
    source: str
    within: float | None
    picture: bytes

    @property
    def unit(self) -> str:
        """Of the quantity; K of differences of temperature."""
        unit = UNITS[self.column.split(".")[1]]
        return "K" if unit == "°C" else unit

    @property
    def uncertainty_text(self) -> str:
        """The uncertainty with its unit."""
        given = self.uncertainty
        return given if isinstance(given, str) else f"± {given:.3g} {self.unit}".strip()

    @property
    def image(self) -> str:
        """The picture as a data URI."""
        return "data:image/png;base64," + b64encode(self.picture).decode("ascii")


def overlays(experiment: Experiment, results: Results) -> list[Overlay]:
    """Return all measured curves of an experiment beside a run of its case."""
    known = {curve.of: curve for curve in experiment.facts.curves}
    made = []
    for column, deviation in results.deviations.items():
        curve = known.get(column)
        uncertainty = curve.uncertainty if curve else "not stated"
        source = curve.source if curve else experiment.facts.source
        made.append(
            Overlay(column, deviation, uncertainty, source,
                    share_within(results, column, uncertainty),
                    drawn(results, column, uncertainty))
        )  # fmt: skip
    return made


def share_within(results: Results, column: str, uncertainty: float | str) -> float | None:
    """Return the share of measured moments at which computed and measured agree.

    Args:
        results: of the run.
        column: of probes.csv.
        uncertainty: in SI units, or "not stated".
    """
    if isinstance(uncertainty, str):
        return None
    time, measured = results.probes["time"], results.measured[column]
    inside = (measured.time >= time[0]) & (measured.time <= time[-1])
    computed = np.interp(measured.time[inside], time, results.probes[column])
    return float(np.mean(np.abs(computed - measured.values[inside]) <= uncertainty))


def drawn(results: Results, column: str, uncertainty: float | str) -> bytes:
    """Return a computed curve and the points of the measured one as PNG."""
    time, measured = results.probes["time"], results.measured[column]
    every = max(len(measured.time) // MOST_POINTS, 1)
    bars = None if isinstance(uncertainty, str) else uncertainty
    with figure(7.0, 3.2) as (canvas, stream):
        axis = canvas.subplots()
        axis.plot(time, results.probes[column], color=COLOURS[0], linestyle="-", label="computed")
        axis.errorbar(
            measured.time[::every], measured.values[::every], yerr=bars, linestyle="none",
            marker="o", markersize=4, markerfacecolor="none", elinewidth=0.8, color=COLOURS[1],
            label="measured",
        )  # fmt: skip
        axis.set_xlim(time[0], time[-1])
        axis.set_xlabel("time [s]")
        axis.set_ylabel(f"{column} [{UNITS[column.split('.')[1]]}]")
        axis.legend()
        canvas.savefig(stream, dpi=DOTS_PER_INCH)
        return stream.getvalue()


def write_page(folder: Path, experiment: Experiment, results: Results) -> list[Overlay]:
    """Write validation.html into a folder and return its overlays."""
    made = overlays(experiment, results)
    text = template("validation.html.j2").render(
        experiment=experiment, overlays=made, record=results.record
    )
    write_whole(folder / PAGE, text)
    return made


def template(name: str) -> jinja2.Template:
    """Return the template of a page of an experiment."""
    loader = jinja2.PackageLoader("castx.proof.validation", "templates")
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined
    )
    return environment.get_template(name)
