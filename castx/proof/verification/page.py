"""verification.html: one offline page with the verdict, picture and errors of each verification."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import jinja2
import numpy as np
from matplotlib.axes import Axes

from castx.environment import versions
from castx.proof.verification.verdict import LEAST_ORDER, Verdict
from castx.proof.verification.verification import Answer, Comparison
from castx.report.style import COLOURS, figure
from castx.results.files.folder import write_whole

PAGE = "verification.html"
DOTS_PER_INCH = 80
MOST_POINTS = 60
"""Of a computed curve that are drawn, about."""


def write_page(folder: Path, verdicts: Sequence[Verdict], *, quick: bool, ranks: int) -> Path:
    """Write verification.html into a folder and return its path.

    Args:
        folder: created if it does not exist.
        verdicts: of all that was run.
        quick: whether the coarser levels were taken.
        ranks: on which it ran.
    """
    loader = jinja2.PackageLoader("castx.proof.verification", "templates")
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined
    )
    environment.filters |= {"error": error_text, "value": value_text, "order": order_text}
    text = environment.get_template("verification.html.j2").render(
        verdicts=verdicts, quick=quick, ranks=ranks, least_order=LEAST_ORDER,
        missed=[v.verification.number for v in verdicts if not v.met],
        when=datetime.now(UTC).strftime("%Y-%m-%d"), versions=versions(), picture=picture,
    )  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / PAGE
    write_whole(target, text)
    return target


def value_text(number: float, unit: str) -> str:
    """Return a number with its unit."""
    return f"{number:.6g} {unit}".strip()


def error_text(error: float, answer: Answer) -> str:
    """Return an error or a tolerance as a share of the scale, or in the unit of the answer."""
    if answer.scale == 1.0 and answer.exact == 0.0:
        return f"{error:.2g} {answer.unit}".strip()
    return f"{100 * error:.2g} %"


def order_text(order: float | None) -> str:
    """Return an observed order."""
    return "–" if order is None else f"{order:.2f}"


def picture(verdict: Verdict) -> str:
    """Return computed beside exact, and the error over mesh or step, as a data URI."""
    finest = verdict.runs[-1].outcome.comparison
    falls = len(verdict.runs) > 1
    with figure(8.4 if falls else 5.4, 3.0) as (canvas, stream):
        axes = canvas.subplots(1, 2 if falls else 1, width_ratios=(5, 3) if falls else None,
                               squeeze=False)[0]  # fmt: skip
        draw_comparison(axes[0], finest)
        if falls:
            draw_fall(axes[1], verdict)
        # Half the bytes of PNG, and no loss.
        canvas.savefig(stream, dpi=DOTS_PER_INCH, format="webp", pil_kwargs={"lossless": True})
        return "data:image/webp;base64," + b64encode(stream.getvalue()).decode("ascii")


def draw_comparison(axis: Axes, comparison: Comparison) -> None:
    """Draw exact curves as lines and computed ones as open circles.

    Args:
        axis: where to.
        comparison: the curves.
    """
    for curve, colour in zip(comparison.curves, COLOURS, strict=False):
        every = max(len(curve.x) // MOST_POINTS, 1)
        axis.plot(curve.exact_x, curve.exact, color=colour, linestyle="-",
                  label=f"{curve.name}, exact")  # fmt: skip
        axis.plot(
            curve.x[::every], curve.computed[::every], linestyle="none", marker="o", markersize=4,
            markerfacecolor="none", color=colour, label=f"{curve.name}, computed",
        )  # fmt: skip
    axis.set_xlabel(comparison.abscissa)
    axis.set_ylabel(comparison.ordinate)
    axis.legend(loc="best", fontsize=8)


def draw_fall(axis: Axes, verdict: Verdict) -> None:
    """Draw the error over element size or step, beside the least order that is demanded.

    Args:
        axis: where to.
        verdict: of several levels.
    """
    verification = verdict.verification
    sizes = np.array([verification.measure(run.level) for run in verdict.runs])
    errors = np.array([run.outcome.norm for run in verdict.runs])
    axis.loglog(sizes, errors, marker="o", color=COLOURS[0], linestyle="-", label="error")
    axis.loglog(sizes, errors[0] * (sizes / sizes[0]) ** LEAST_ORDER, color=COLOURS[6],
                linestyle=":", label="slowest fall allowed")  # fmt: skip
    axis.set_xlabel("step over the time" if verification.refined == "step" else "element size [m]")
    axis.set_ylabel("error")
    axis.set_xticks(sizes, [f"{size:.2g}" for size in sizes])
    axis.minorticks_off()
    axis.legend(loc="best", fontsize=8)
