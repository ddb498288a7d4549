"""Curves over time as the page draws them: computed and measured ones in one diagram."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.report.moments import moments
from castx.results.field_times import FRACTIONS
from castx.results.reading import Results
from castx.results.states.snapshot import FULLY_SOLID

OVER_TIME = "time [s]"
"""Label of most abscissas; diagrams with the same one show their numbers at one pointer."""
NUMERICS = "How the solution went"
DIGITS = 7
"""Of the numbers of a curve."""
NOTHING = 1e-6
"""Change of a temperature that is none [K]: means are rounded."""


@dataclass(frozen=True)
class Panel:
    """One diagram.

    Args:
        label: of the ordinate, with its unit.
        lines: ordinates by the name of the curve.
        levels: thin horizontal lines, by name.
        logarithmic: whether the ordinate is.
        steps: whether each value is that of the whole step before.
        least: height that the ordinate has at least, so that round-off is drawn as zero.
        points: times [s] and ordinates of what was measured, by the name of its curve.
        abscissa: its label, with its unit.
    """

    label: str
    lines: Mapping[str, FloatArray]
    levels: Mapping[str, float] = field(default_factory=dict)
    logarithmic: bool = False
    steps: bool = False
    least: float = 0.0
    points: Mapping[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    abscissa: str = OVER_TIME


@dataclass(frozen=True)
class Section:
    """Diagrams below each other.

    Args:
        title: heading.
        caption: what is seen.
        time: of the steps [s], (steps,), or what its diagrams have as abscissa.
        panels: the diagrams.
        until: moments up to which they may be looked at [s], by name.
    """

    title: str
    caption: str
    time: FloatArray
    panels: Sequence[Panel]
    until: Mapping[str, float] = field(default_factory=dict)


def run_sections(run: Results) -> list[Section]:
    """Return the curves over time that a run has data for; how the solution went is the last."""
    of_probes, of_steps = run.probes["time"], run.history["time"]
    found = [
        Section("Cooling curves", "Temperatures at the probes.", of_probes, cooling(run)),
        Section(
            "Temperatures of the bodies",
            "The hottest node, the mean over the volume, and the coldest node.",
            of_steps, body_temperatures(run),
        ),
        Section(
            "Solidification and heat",
            "Solid fraction of the bodies, and the heat that has passed the interfaces.",
            of_steps, solidification(run),
        ),
        Section(
            "Gap and contact",
            "Air gap, contact pressure and the heat transfer coefficient that follows from them.",
            of_probes, contact(run),
        ),
        Section(
            "Gaps of the interfaces",
            "Mean over the area, and largest, of each interface whose gap changes.",
            of_steps, interface_gaps(run),
        ),
        Section("Displacements", "Displacements at the probes.", of_probes, displacements(run)),
        Section(
            NUMERICS,
            "Step size, iterations of each step with all passes and tries, and the energy balance.",
            of_steps, numerics(run),
        ),
    ]  # fmt: skip
    until = moments_to_look_at(run)
    return [replace(section, until=until) for section in found if section.panels]


def moments_to_look_at(run: Results) -> dict[str, float]:
    """Return when all is solid and when stages begin [s], by name: a cold part takes hours.

    Args:
        run: the results.
    """
    events = {name: time for time, names in moments(run).items() for name in names.split(", ")}
    wanted = {FRACTIONS[FULLY_SOLID], *(name for name in events if name.startswith("stage "))}
    return {name: time for name, time in events.items() if name in wanted}


def merged(runs: Mapping[str, Sequence[Section]]) -> list[dict[str, Any]]:
    """Return the diagrams of runs for JSON, curves of the same name in one diagram.

    Args:
        runs: sections by the label of their run; the label of a single run is not shown.
    """
    several = len(runs) > 1
    pages: dict[str, dict[str, Any]] = {}
    for label, sections in runs.items():
        for section in sections:
            page = pages.setdefault(
                section.title,
                {"title": section.title, "caption": section.caption, "panels": {}, "until": {}},
            )
            for event, time in section.until.items():  # of several runs the last one
                page["until"][event] = max(time, page["until"].get(event, time))
            for panel in section.panels:
                drawn = page["panels"].setdefault(panel.label, described(panel))
                drawn["tables"] += tables(panel, section.time, label if several else "")
    return [{**page, "panels": list(page["panels"].values())} for page in pages.values()]


def described(panel: Panel) -> dict[str, Any]:
    """Return a diagram without its curves."""
    return {
        "label": panel.label, "levels": dict(panel.levels), "logarithmic": panel.logarithmic,
        "steps": panel.steps, "least": panel.least, "abscissa": panel.abscissa, "tables": [],
    }  # fmt: skip


def tables(panel: Panel, time: FloatArray, run: str) -> list[dict[str, Any]]:
    """Return the curves of a diagram: a table of the computed ones, and one of each measured one.

    Args:
        panel: the diagram.
        time: of its curves [s].
        run: stands behind the names of the curves, unless it is empty.
    """
    behind = f", {run}" if run else ""
    lines = [
        {"name": f"{name}{behind}", "curve": name, "run": run, "values": numbers(values)}
        for name, values in panel.lines.items()
    ]
    found = [{"time": numbers(time), "measured": False, "lines": lines}]
    for name, (at, values) in panel.points.items():
        line = {"name": f"{name}{behind}, measured", "curve": name, "run": run,
                "values": numbers(values)}  # fmt: skip
        found.append({"time": numbers(at), "measured": True, "lines": [line]})
    return found


def numbers(values: FloatArray) -> list[float | None]:
    """Return values with DIGITS digits, None in place of those that are not finite."""
    return [float(f"{x:.{DIGITS}g}") if np.isfinite(x) else None for x in values]


def columns(
    series: Mapping[str, FloatArray], ending: str, factor: float = 1.0
) -> dict[str, FloatArray]:
    """Return the columns "NAME.ending" of a series by NAME.

    Args:
        series: columns by name.
        ending: last part of their names.
        factor: on the values.
    """
    suffix = f".{ending}"
    return {
        name.removesuffix(suffix): factor * values
        for name, values in series.items()
        if name.endswith(suffix)
    }


def probed(
    run: Results,
    label: str,
    quantity: str,
    factor: float = 1.0,
    *,
    levels: Mapping[str, float] | None = None,
    least: float = 0.0,
) -> Panel:
    """Return a quantity at all probes that record it, with its measured curves.

    Args:
        run: the results.
        label: of the ordinate, with its unit.
        quantity: ending of the columns.
        factor: from SI to the unit of the label.
        levels: thin horizontal lines, by name.
        least: height that the ordinate has at least.
    """
    values = {name: curve.values for name, curve in run.measured.items()}
    points = {
        name: (run.measured[f"{name}.{quantity}"].time, ordinates)
        for name, ordinates in columns(values, quantity, factor).items()
    }
    lines = columns(run.probes, quantity, factor)
    return Panel(label, lines, levels or {}, least=least, points=points)


def filled(panels: Sequence[Panel]) -> list[Panel]:
    """Return the panels that have lines."""
    return [panel for panel in panels if panel.lines]


def cooling(run: Results) -> list[Panel]:
    """Return the cooling curves, with the freezing ranges as levels."""
    levels = freezing_levels(run)
    return filled([probed(run, "temperature [°C]", "temperature", levels=levels)])


def body_temperatures(run: Results) -> list[Panel]:
    """Return the temperatures of the bodies that change theirs: they need no probe."""
    levels, panels = freezing_levels(run), []
    for label, ending in (("hottest", "max"), ("mean", "mean"), ("coldest", "min")):
        found = columns(run.history, f"{ending}_temperature")
        known = {body: T[np.isfinite(T)] for body, T in found.items()}
        moving = [body for body, T in known.items() if T.size and np.ptp(T) > NOTHING]
        panels.append(Panel(f"{label} [°C]", {b: found[b] for b in moving}, levels))
    return filled(panels)


def freezing_levels(run: Results) -> dict[str, float]:
    """Return the ends of the freezing ranges [°C] by their names."""
    levels: dict[str, float] = {}
    for name, body in run.record["bodies"].items():
        if name in run.freezing:
            solidus, liquidus = body["freezes"]
            ends = {"solidus": solidus, "liquidus": liquidus}
            levels |= ends if solidus < liquidus else {"melting point": solidus}
    return levels


def solidification(run: Results) -> list[Panel]:
    """Return solid fractions, and the heat that has passed each interface."""
    fractions = columns(run.history, "solid_fraction", 100.0)
    heat = {
        name: values
        for name, values in columns(run.history, "heat", 1e-3).items()
        if name in run.record["interfaces"]
    }
    per = "" if run.model in ("axisymmetric", "3d") else "/m"
    freezing = {name: fractions[name] for name in run.freezing}
    return filled([Panel("solid [%]", freezing), Panel(f"heat passed [kJ{per}]", heat)])


def contact(run: Results) -> list[Panel]:
    """Return gap, contact pressure and heat transfer coefficient at the probes."""
    return filled(
        [
            probed(run, "gap [µm]", "gap", 1e6, least=1.0),
            probed(run, "contact pressure [MPa]", "contact_pressure", 1e-6, least=0.1),
            probed(run, "h [W/m²/K]", "heat_transfer_coefficient"),
        ]
    )


def interface_gaps(run: Results) -> list[Panel]:
    """Return the mean and the largest gap of the interfaces whose gap changes."""
    panels = []
    for label, ending in (("mean gap [µm]", "mean_gap"), ("largest gap [µm]", "max_gap")):
        found = columns(run.history, ending, 1e6)
        moving = {name: gap for name, gap in found.items() if len(set(gap[np.isfinite(gap)])) > 1}
        panels.append(Panel(label, moving, least=1.0))
    return filled(panels)


def displacements(run: Results) -> list[Panel]:
    """Return the displacements at the probes by direction."""
    named = [name for name in run.probes if ".displacement." in name]
    directions = sorted({name.rpartition(".")[2] for name in named})
    return filled(
        [
            probed(run, f"displacement {axis} [µm]", f"displacement.{axis}", 1e6, least=1.0)
            for axis in directions
        ]
    )


def numerics(run: Results) -> list[Panel]:
    """Return step size, iterations and energy error."""
    history = run.history
    panels = [
        Panel("step [s]", {"step": history["step"]}, steps=True),
        Panel("heat iterations", {"heat": history["heat_iterations"]}, steps=True),
        Panel(
            "iterations, passes",
            {"mechanics": history["mechanics_iterations"], "passes": history["passes"]},
            steps=True,
        ),
    ]
    if "energy_error" in history and np.any(history["energy_error"] != 0.0):
        error = {"energy error": np.abs(history["energy_error"])}
        panels.append(Panel("energy error", error, logarithmic=True))
    return panels
