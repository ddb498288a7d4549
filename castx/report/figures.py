"""The figures of the report: curves of probes and history, pictures of the fields."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.report.curves import Panel, curves, row
from castx.report.display import display
from castx.report.moments import moments
from castx.report.pictures import (
    Scale,
    View,
    chosen_times,
    deformed,
    exaggeration,
    limits_of,
    picture,
)
from castx.results.foundry_fields import PASSING
from castx.results.reading import Results

State = Mapping[str, pyvista.UnstructuredGrid]
NUMERICS = "How the solution went"
SMALLEST_RANGE = 1e-6
"""Range of values, in the unit shown, below which a picture would show round-off."""


@dataclass(frozen=True)
class Figure:
    """A picture with its heading and what it shows."""

    title: str
    caption: str
    png: bytes

    @property
    def source(self) -> str:
        """The picture as a data URI."""
        return "data:image/png;base64," + b64encode(self.png).decode("ascii")


def curve_figures(run: Results) -> list[Figure]:
    """Return the curves over time that a run has data for."""
    found = []
    for title, caption, panels, series in (
        ("Cooling curves", "Temperatures at the probes.", cooling(run), run.probes),
        (
            "Solidification and heat",
            "Solid fraction of the bodies, and the heat that has passed the interfaces.",
            solidification(run),
            run.history,
        ),
        (
            "Gap and contact",
            "Air gap, contact pressure and the heat transfer coefficient that follows from them.",
            contact(run),
            run.probes,
        ),
        ("Displacements", "Displacements at the probes.", displacements(run), run.probes),
        (
            NUMERICS,
            "Step size, iterations of each step with all passes and tries, and the energy balance.",
            numerics(run),
            run.history,
        ),
    ):
        if panels:
            found.append(Figure(title, caption, curves(series["time"], panels)))
    return found


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
    """Return a quantity at all probes that record it, with what was measured there.

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
    levels: dict[str, float] = {}
    for name, body in run.record["bodies"].items():
        if name in run.freezing:
            solidus, liquidus = body["freezes"]
            ends = {"solidus": solidus, "liquidus": liquidus}
            levels |= ends if solidus < liquidus else {"melting point": solidus}
    return filled([probed(run, "temperature [°C]", "temperature", levels=levels)])


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


@dataclass(frozen=True)
class Topic:
    """A field that the report shows.

    Args:
        field: its name.
        title: heading.
        caption: what is seen.
        label: of the colour bar.
        colours: name of the colour map.
        factor: from SI to the unit of the label.
        melting: whether only the bodies that freeze show it; else the others have colours of
            their own, `beside`.
        final: whether it is shown at the end only.
        front: whether the line f_s = 0.5 is drawn.
        share: of the values inside the colours.
        moved: whether bodies are drawn deformed.
        outside: whether it lives on the outside: shown in 3-D, without the bodies around.
    """

    field: str
    title: str
    caption: str
    label: str
    colours: str
    factor: float = 1.0
    melting: bool = False
    beside: str = "cividis"
    final: bool = False
    front: bool = False
    share: float = 1.0
    moved: bool = False
    outside: bool = False


TOPICS = (
    Topic("temperature", "Temperature", "The blue line is f_s = 0.5.", "temperature [°C]",
          "inferno", front=True, beside="viridis"),
    Topic("solid_fraction", "Solid fraction", "", "solid fraction", "Blues", melting=True),
    Topic("von_mises", "Distortion and stress", "", "von Mises stress [MPa]", "viridis", 1e-6,
          share=0.99, moved=True),
    Topic("gap", "Gap", "The castings seen from outside, without their moulds.", "gap [µm]",
          "YlGnBu", 1e6, melting=True, outside=True),
    Topic("contact_pressure", "Contact pressure", "", "contact pressure [MPa]", "YlOrRd", 1e-6,
          melting=True, share=0.99, outside=True),
    Topic("solidification_time", "Local solidification time",
          "Time between liquidus and solidus.", "time [s]", "cividis", melting=True, final=True),
    Topic("niyama", "Niyama criterion",
          "G/√Ṫ at {front}. Shrinkage porosity is likely where it is low; the limit depends on "
          "the alloy, for steel castings it is near 1 K^½ s^½/mm.",
          "Niyama [K$^{1/2}$ s$^{1/2}$/mm]", "RdYlGn", 1e-3, melting=True, final=True, share=0.9),
    Topic("dimensionless_niyama", "Dimensionless Niyama criterion",
          "λ2 G √(Δp_c/(μ β ΔT_f Ṫ)) at {front}. Pores open where it is low.",
          "Ny* [1]", "RdYlGn", melting=True, final=True, share=0.9),
    Topic("pore_fraction", "Shrinkage porosity",
          "Pores where the suction of the mush reaches its limit, from the history at {front}: arm "
          "spacing, viscosity and the limit are uncertain by tens of percent, gas is left out, and "
          "so is feeding over a distance.",
          "pores [%]", "YlOrRd", 100.0, melting=True, final=True, share=0.99),
    Topic("clyne_davies", "Hot-tearing ratio of Clyne and Davies",
          "Time from f_s = 0.9 to 0.99 over that from 0.4 to 0.9: it compares places, without a "
          "limit, and has no stress in it.",
          "ratio [1]", "YlOrRd", melting=True, final=True, share=0.9),
    Topic("modulus", "Thermal modulus",
          "√(t_s/C) of the time from pouring until all is solid; C holds for sand, not for dies.",
          "modulus [mm]", "cividis", 1e3, melting=True, final=True),
    Topic("front_speed", "Speed of the front", "At {front}.", "speed [mm/s]", "viridis", 1e3,
          melting=True, final=True, share=0.9),
    Topic("arm_spacing", "Secondary arm spacing", "From the cooling rate at {front}.",
          "spacing [µm]", "viridis", 1e6, melting=True, final=True),
    Topic("yield_strength", "Yield strength by arm spacing",
          "A regression, valid for the heat treatment of its samples alone.",
          "yield strength [MPa]", "viridis", 1e-6, melting=True, final=True),
)  # fmt: skip


def field_figures(run: Results) -> list[Figure]:
    """Return the figures of the written fields."""
    times = chosen_times(run.times, moments(run))
    states = [run.grids(time) for time in times]
    titles = [f"{time:.4g} s\n{what}".strip() for time, what in times.items()]
    with display():
        topics = [*TOPICS, *passing_topics(states)]
        return [figure for topic in topics for figure in topic_figures(run, topic, titles, states)]


def passing_topics(states: Sequence[State]) -> list[Topic]:
    """Return the topics of the times at which solid fractions pass, which have their own names."""
    names = {name for state in states for grid in state.values() for name in grid.point_data}
    fractions = sorted(float(n.removeprefix(PASSING)) for n in names if n.startswith(PASSING))
    return [
        Topic(f"{PASSING}{fraction!r}", f"Time of solid fraction {fraction:g}",
              "From when the casting was poured.", "time [s]", "cividis", melting=True, final=True)
        for fraction in fractions
    ]  # fmt: skip


def topic_figures(
    run: Results, topic: Topic, titles: Sequence[str], states: Sequence[State]
) -> Iterator[Figure]:
    """Yield the figure of a field if it was written and varies.

    Args:
        run: the results.
        topic: the field.
        titles: of the pictures.
        states: the bodies at their times.
    """
    bodies = run.freezing or list(states[0])
    model = run.model
    if topic.final:
        titles, states = titles[-1:], states[-1:]
    if topic.outside:
        states = [{name: state[name] for name in bodies if name in state} for state in states]
    limits = limits_of(states, topic.field, bodies, topic.share)
    if limits is None or (topic.outside and model != "3d"):
        return
    if topic.factor * (limits[1] - limits[0]) < SMALLEST_RANGE:
        return
    beside = None if topic.melting else scale_beside(topic, states, bodies)
    view, factor = topic_view(model, topic, states, bodies)
    if topic.field == "solid_fraction":
        limits = (0.0, 1.0)
    images = [
        picture(view, state, topic.field, limits, colours=topic.colours, coloured=bodies,
                front=topic.front, exaggeration=factor, beside=beside)
        for state in states
    ]  # fmt: skip
    scaled = (limits[0] * topic.factor, limits[1] * topic.factor)
    label, second = topic.label, None
    if beside is not None:
        ends = (beside.limits[0] * topic.factor, beside.limits[1] * topic.factor)
        second = (f"{topic.label}, {' and '.join(beside.bodies)}", ends, beside.colours)
        label = f"{topic.label}, {' and '.join(bodies)}"
    caption = topic.caption.replace("{front}", str(run.record.get("front", "f_s = 0.9")))
    if factor:
        caption = f"Displacements drawn {factor:g} times as large as they are. {caption}".strip()
    yield Figure(topic.title, caption, row(images, titles, label, scaled, topic.colours, second))


def scale_beside(topic: Topic, states: Sequence[State], bodies: Sequence[str]) -> Scale | None:
    """Return the colours of the bodies beside those that freeze, None where there are none.

    Args:
        topic: the field.
        states: the bodies at the times of the pictures.
        bodies: those that freeze.
    """
    names = sorted({name for state in states for name in state} - set(bodies))
    limits = limits_of(states, topic.field, names, topic.share)
    return None if limits is None else Scale(limits, topic.beside, tuple(names))


def topic_view(
    model: str, topic: Topic, states: Sequence[State], bodies: Sequence[str]
) -> tuple[View, float]:
    """Return the view of a field, and the factor on the displacements.

    Args:
        model: of the run.
        topic: the field.
        states: the bodies at the times of the pictures.
        bodies: those that freeze.
    """
    castings = [states[0][name] for name in bodies if name in states[0]]
    view = View.of(model, states[-1].values(), topic.outside, castings)
    factor = exaggeration(view, states[-1]) if topic.moved else 0.0
    if factor:
        moved = [deformed(grid, factor) for grid in states[-1].values()]
        view = View.of(model, [*states[0].values(), *moved], castings=castings)
    return view, factor
