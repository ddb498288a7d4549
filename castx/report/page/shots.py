"""Still pictures of the report: one for each finding, and a row of moments for paper."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import pyvista
from matplotlib import colormaps
from matplotlib.image import imsave

from castx.arrays import FloatArray
from castx.case.fields.motion import DEVIATION
from castx.input.units import plain_text, seconds_text
from castx.report.browser_scene import shown_range, shown_times
from castx.report.moments import moments
from castx.report.page.assets import data_uri
from castx.report.pictures import (
    Image,
    Scale,
    View,
    box,
    chosen_times,
    deformed,
    exaggeration,
    limits_of,
    merged,
    outer_faces,
    picture,
)
from castx.report.reported import ReportedRun, State
from castx.report.summary.finding import Finding, Shown
from castx.report.topics import Topic, topics_of
from castx.results.states.quantities import PRINCIPAL

PIXELS = 480
"""Largest side of a picture."""
MOST_STILLS = 4
RING = (224, 0, 122)
MARGIN = 6


@dataclass(frozen=True)
class Bar:
    """Colours below a picture: label with unit, text of both ends, colours for CSS."""

    label: str
    low: str
    high: str
    colours: str


@dataclass(frozen=True)
class Shot:
    """A picture with its caption.

    Attributes:
        title: what is seen.
        source: the picture as a data URI.
        bars: of its colours.
        field: that it shows.
        time: [s].
    """

    title: str
    source: str
    bars: tuple[Bar, ...]
    field: str
    time: float


DISTANCE = Topic(
    "distance", "Displacement", "How far each point has moved.", "mm", "viridis", 1e3, melting=True
)
"""Size of the displacement, which stands in for the deviation from the nominal surface."""
STAND_INS = {
    PRINCIPAL[0]: "von_mises", "stress_error": "von_mises", DEVIATION: DISTANCE.field,
    "solid_fraction": "temperature",
}  # fmt: skip
"""Fields that are shown where others were not written."""
LEAST_SHOWN = 1e-3
"""Part of the range of colours below which the number at an end is shown as zero."""
INNER = 0.35
"""Part of the extent of the castings, either way from their middle, within which a cut runs."""
BEFORE = 2e-3
"""Part of the extent of the castings by which a cut runs before the place that it shows."""
SIDEWAYS = 0.3
"""Part of a normal along an axis from which a face looks to that side."""
Limits = tuple[float, float]
"""Values at the ends of colours."""


def finding_shot(
    run: ReportedRun, finding: Finding, limits: Mapping[str, Limits] | None = None
) -> Shot | None:
    """Return the picture of a finding; None where its field was not written, or does not vary.

    Call it inside `castx.report.display.display()`.

    Args:
        run: the results.
        finding: with its place marked by a ring, unless it is seen from outside.
        limits: values at the ends of the colours, as `finding_limits` has them; None: its own.
    """
    shown = None if finding.shown is None else drawable(run, finding.shown)
    if shown is None:
        return None
    time = run.nearest(shown.time, shown.bodies[0])
    return shot(run, topic_of(shown.field), time, shown, finding.place, limits or {})


def finding_limits(run: ReportedRun, finding: Finding) -> dict[str, Limits]:
    """Return the values at the ends of the colours of the picture of a finding.

    They are named by field and colour map: castings and the bodies around them have one each.
    """
    shown = None if finding.shown is None else drawable(run, finding.shown)
    if shown is None:
        return {}
    state = run.grids(run.nearest(shown.time, shown.bodies[0]))
    scales = scales_of(seen(state, shown), topic_of(shown.field), shown.bodies)
    return {f"{shown.field} {scale.colours}": scale.limits for scale in scales}


def seen(state: State, shown: Shown) -> State:
    """Return the bodies that a picture has, with the distances that it shows."""
    if shown.outside:
        state = {name: grid for name, grid in state.items() if name in shown.bodies}
    if shown.field != DISTANCE.field:
        return state
    return {name: _with_distances(grid) for name, grid in state.items()}


def _with_distances(grid: pyvista.UnstructuredGrid) -> pyvista.UnstructuredGrid:
    """Return a body with the size of its displacement."""
    found = grid.copy(deep=False)
    if "displacement" in found.point_data:
        moved = np.linalg.norm(found.point_data["displacement"], axis=1)
        found.point_data[DISTANCE.field] = moved
    return found


def drawable(run: ReportedRun, shown: Shown) -> Shown | None:
    """Replace a field that was not written by one that tells of the same; None if there is none."""
    time = run.nearest(shown.time, shown.bodies[0])
    state = run.grids(time)
    written = {n for name in shown.bodies if name in state for n in state[name].array_names}
    if "displacement" in written:
        written.add(DISTANCE.field)
    found = (field for field in (shown.field, STAND_INS.get(shown.field)) if field in written)
    field = next(found, None)
    return None if field is None else replace(shown, field=field)


def topic_of(field: str) -> Topic:
    """Return the topic of a field."""
    return DISTANCE if field == DISTANCE.field else next(topics_of([field]))


def stills(run: ReportedRun) -> list[Shot]:
    """Return still pictures of one field, for print and for browsers without WebGL."""
    written = {name for grid in run.grids().values() for name in grid.array_names}
    field = next((name for name in ("temperature", "von_mises") if name in written), None)
    if field is None:
        return []
    what = chosen_times(run.times, moments(run))
    times = shown_times(list(what), [], MOST_STILLS)
    bodies = tuple(run.freezing or run.bodies_at())
    made = [shot(run, topic_of(field), time, Shown(field, bodies)) for time in times]
    return [
        replace(one, title=f"t = {seconds_text(time)}" + (f": {what[time]}" if what[time] else ""))
        for one, time in zip(made, times, strict=True)
        if one is not None
    ]


def shot(
    run: ReportedRun,
    topic: Topic,
    time: float,
    shown: Shown,
    place: Sequence[float] | None = None,
    limits: Mapping[str, Limits] = MappingProxyType({}),
) -> Shot | None:
    """Return a picture of a field; None where it does not vary.

    Args:
        run: the results.
        topic: the field.
        time: one of those with fields [s].
        shown: how.
        place: that gets a ring, unless it is seen from outside (gdim,) [m].
        limits: values at the ends of colours in place of its own, as `finding_limits` has them.
    """
    state = seen(run.grids(time), shown)
    scales = [
        replace(scale, limits=limits.get(f"{topic.field} {scale.colours}", scale.limits))
        for scale in scales_of(state, topic, shown.bodies)
    ]
    if not scales:
        return None
    view, factor = view_and_factor(run, state, shown, place)
    image = picture(
        view, state, topic.field, scales[0].limits, colours=scales[0].colours,
        coloured=scales[0].bodies, front=topic.front, exaggeration=factor,
        beside=scales[1] if len(scales) > 1 else None,
    )  # fmt: skip
    if place is not None and not shown.outside:
        point = moved_place(state, shown.bodies, place, factor)
        image = ringed(image, view, point) if is_drawn(view, point) else image
    title = topic.title + (f", displacements {factor:g} times" if factor else "")
    bars = tuple(bar(topic, scale) for scale in scales)
    return Shot(title, png(trimmed(image)), bars, topic.field, time)


def scales_of(state: State, topic: Topic, bodies: Sequence[str]) -> Iterator[Scale]:
    """Yield the colours of the shown bodies, then of the bodies around them."""
    others = () if topic.melting else tuple(sorted(set(state) - set(bodies)))
    for names, colours in ((tuple(bodies), topic.colours), (others, topic.beside)):
        there = tuple(name for name in names if name in state)
        found = limits_of([state], topic.field, there, 1.0)
        if found is None:
            continue
        values = np.concatenate([state[n][topic.field] for n in there
                                 if topic.field in state[n].array_names])  # fmt: skip
        limits = shown_range(np.asarray(values, dtype=np.float64), topic)
        # What does not vary, such as the stress of rigid bodies, gets one unit of those shown.
        yield Scale(limits or (found[0], found[0] + 1.0 / topic.factor), colours, there)


def view_and_factor(
    run: ReportedRun, state: State, shown: Shown, place: Sequence[float] | None = None
) -> tuple[View, float]:
    """Return the view of a picture, and the factor on the displacements.

    Args:
        run: the results.
        state: what is in the picture.
        shown: how.
        place: through which a cut goes, if that leaves enough of the castings, or to whose side
            one looks from outside and at whole bodies; None: the middle, and the same side.
    """
    # A mould that lies at the side of the whole is cut with its casting, not seen from there.
    inner = [name for name in run.freezing if name in state] or shown.bodies
    castings = [state[name] for name in inner if name in state]
    view = View.of(run.model, state.values(), shown.outside, castings)
    factor = exaggeration(view, state) if shown.moved else 0.0
    if factor:
        both = [*state.values(), *(deformed(grid, factor) for grid in state.values())]
        view = View.of(run.model, both, castings=castings)
    coloured = [state[name] for name in shown.bodies if name in state]
    if view.cut is not None and place is not None and castings:
        drawn = [deformed(grid, factor) for grid in castings]
        y = float(moved_place(state, shown.bodies, place, factor)[1])
        view = replace(view, cut=_through(y, drawn))
    alone = view.cut is None and set(state) <= set(shown.bodies)
    outside = shown.outside or alone
    if outside and place is not None and coloured and view.direction is not None:
        view = replace(view, direction=_facing(view.direction, coloured[0], place))
    return replace(view, pixels=PIXELS), factor


def _through(y: float, castings: Sequence[pyvista.UnstructuredGrid]) -> float:
    """Return the y of a cut at a place, or the nearest that shows enough of the castings.

    It runs a little before the place, which may lie on a face along the cut: a cut in that face
    would leave crumbs of cells.
    """
    low, high = (corner[1] for corner in merged([box(grid) for grid in castings]))
    middle, half = 0.5 * (low + high), INNER * (high - low)
    return float(np.clip(y - BEFORE * (high - low), middle - half, middle + half))


def _facing(
    direction: FloatArray, grid: pyvista.UnstructuredGrid, place: Sequence[float]
) -> FloatArray:
    """Return the direction to an eye on the side to which a surface looks at a place."""
    surface = outer_faces(grid).compute_normals(
        cell_normals=False, split_vertices=False, consistent_normals=False
    )
    normal = np.asarray(surface["Normals"])[surface.find_closest_point(list(place))]
    sides = np.where(np.abs(normal) > SIDEWAYS, np.sign(normal), np.sign(direction))
    return np.asarray(np.abs(direction) * sides, dtype=np.float64)


def moved_place(
    state: State, bodies: Sequence[str], place: Sequence[float], factor: float
) -> FloatArray:
    """Return where a place is drawn (3,) [m], with the displacement of the nearest node."""
    point = np.zeros(3)
    point[: len(place)] = place
    grids: list[pyvista.UnstructuredGrid] = [state[name] for name in bodies if name in state]
    if factor and grids and "displacement" in grids[0].point_data:
        nearest = grids[0].find_closest_point(point)
        return np.asarray(point + factor * grids[0]["displacement"][nearest], dtype=np.float64)
    return point


def is_drawn(view: View, point: FloatArray) -> bool:
    """Return whether a place lies in the half that a cut leaves, or there is no cut.

    A cut shows enough of the castings, and so may leave out a place near their front.
    """
    return view.cut is None or bool(point[1] >= view.cut)


def ringed(image: Image, view: View, point: FloatArray) -> Image:
    """Return a picture with a ring round a point."""
    height, width = image.shape[:2]
    centre = 0.5 * (view.low + view.high)
    if view.direction is None:
        right, upward, reach = np.eye(3)[0], np.eye(3)[1], 0.5 * (view.high - view.low)[1]
    else:
        towards = view.direction / np.linalg.norm(view.direction)
        right = np.cross([0.0, 0.0, 1.0], towards)
        right /= np.linalg.norm(right)
        upward, reach = np.cross(towards, right), 0.52 * view.size
    scale = 0.5 * height / reach
    column = 0.5 * width + scale * float(right @ (point - centre))
    line = 0.5 * height - scale * float(upward @ (point - centre))
    rows, columns = np.mgrid[:height, :width]
    distance = np.hypot(rows - line, columns - column)
    found = image.copy()
    found[np.abs(distance - 9.0) < 3.2] = 255
    found[np.abs(distance - 9.0) < 1.8] = RING
    return found


def trimmed(image: Image) -> Image:
    """Return a picture without its white rim."""
    drawn = np.any(image < 250, axis=2)
    rows, columns = (np.flatnonzero(drawn.any(axis=axis)) for axis in (1, 0))
    if rows.size == 0:
        return image
    top, left = max(rows[0] - MARGIN, 0), max(columns[0] - MARGIN, 0)
    return image[top : rows[-1] + MARGIN + 1, left : columns[-1] + MARGIN + 1]


def png(image: Image) -> str:
    """Return a picture as a data URI."""
    stream = io.BytesIO()
    imsave(stream, np.ascontiguousarray(image), format="png")
    return data_uri(stream.getvalue())


def bar(topic: Topic, scale: Scale) -> Bar:
    """Return the colour bar of a picture."""
    steps = colormaps[scale.colours](np.linspace(0.0, 1.0, 17))[:, :3]
    colours = ", ".join("#" + "".join(f"{round(255 * x):02x}" for x in step) for step in steps)
    least = LEAST_SHOWN * (scale.limits[1] - scale.limits[0])
    ends = (0.0 if abs(limit) < least else topic.factor * limit for limit in scale.limits)
    low, high = (plain_text(end) for end in ends)
    return Bar(f"{topic.label}, {', '.join(scale.bodies)}", low, high, colours)


Shots = Mapping[str, Shot]
"""Pictures of findings by their names."""
