"""band.html: what was measured beside the runs of an experiment over its ranges, on one page."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path

from castx.proof.validation.band import BandedExperiment, MeasuredBand
from castx.proof.validation.experiment import Experiment
from castx.proof.validation.page import template
from castx.report.style import COLOURS, DOTS_PER_INCH, figure
from castx.results.files.folder import write_whole
from castx.results.states.quantities import UNITS
from castx.version import __version__

BAND_PAGE = "band.html"


@dataclass(frozen=True)
class DrawnBand:
    """A band as the page shows it.

    Attributes:
        column: of probes.csv.
        told: where the measured curve lies.
        picture: PNG.
    """

    column: str
    told: str
    picture: bytes

    @property
    def image(self) -> str:
        """The picture as a data URI."""
        return "data:image/png;base64," + b64encode(self.picture).decode("ascii")


def curve_text(curve: MeasuredBand) -> str:
    """Return where a measured curve lies, in words."""
    share = curve.share_inside
    if share is None:
        return (
            "not decidable, no curve was read to compare with; 5, 50 and 95 % of the runs are below"
        )
    return f"{100 * share:.0f} % of the measured moments lie in the band of 5 to 95 % of the runs"


def drawn_band(curve: MeasuredBand) -> DrawnBand:
    """Return a band with the measured curve on it as PNG."""
    band = curve.band
    with figure(7.0, 3.2) as (canvas, stream):
        axis = canvas.subplots()
        axis.fill_between(
            band.time, band.low, band.high, color=COLOURS[0], alpha=0.25, label="5 to 95 % of runs"
        )
        axis.plot(band.time, band.middle, color=COLOURS[0], linestyle="-", label="half of them")
        if curve.time.size:
            axis.plot(curve.time, curve.values, linestyle="none", marker="o", markersize=4,
                      markerfacecolor="none", color=COLOURS[1], label="measured")  # fmt: skip
        axis.set_xlim(band.time[0], band.time[-1])
        axis.set_xlabel("time [s]")
        axis.set_ylabel(f"{band.column} [{UNITS[band.column.split('.')[1]]}]")
        axis.legend()
        canvas.savefig(stream, dpi=DOTS_PER_INCH)
        return DrawnBand(band.column, curve_text(curve), stream.getvalue())


def write_band_page(folder: Path, experiment: Experiment, found: BandedExperiment) -> Path:
    """Write band.html into a folder and return its path."""
    text = template("band.html.j2").render(
        experiment=experiment, found=found, version=__version__,
        curves=[drawn_band(curve) for curve in found.curves],
    )  # fmt: skip
    write_whole(folder / BAND_PAGE, text)
    return folder / BAND_PAGE
