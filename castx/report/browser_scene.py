"""The scene of a run: meshes, moments and fields of its bodies, packed for the page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.case.fields.feeding import EMPTIED
from castx.report.moments import moments
from castx.report.packing import packed, packed_values
from castx.report.pictures import View, chosen_times, exaggeration
from castx.report.reported import ReportedRun, State
from castx.report.sunk_bodies import Pipes, surface_of
from castx.report.topics import Topic, topics_of

MOST_MOMENTS = 48
LARGEST = 20_000_000
"""Bytes of fields before they are compressed, about."""
LARGEST_MESH = 6_000_000
"""Bytes of cells beyond which only the surfaces of bodies are shown, which a plane cuts hollow."""
COLOURS = 64
"""Steps of a colour map; the page interpolates between them."""

Kept = dict[str, pyvista.UnstructuredGrid]


def scene(run: ReportedRun) -> dict[str, Any]:
    """Return the data with which a page draws the bodies of a run, for JSON.

    Args:
        run: the results.
    """
    what = chosen_times(run.times, moments(run))
    meshes = first_grids(run)
    hollow = sum(8 * grid.cell_connectivity.size for grid in meshes.values()) > LARGEST_MESH
    hollow = hollow and run.model == "3d"
    names = sorted({n for g in run.grids().values() for n in scalars(g)} | scalars_ever(meshes))
    topics = list(topics_of(names))
    times = shown_times(run.times, list(what), most_moments(meshes, topics, hollow))
    pipes = Pipes.of(run.model, [run.grids(time) for time in times])
    states = [reduced(run.grids(time), hollow, pipes) for time in times]
    view = view_of(run, run.grids())
    return {
        "model": run.model,
        "times": times,
        "moments": [what.get(time, "") for time in times],
        "freezing": [name for name in run.freezing if name in meshes],
        "hollow": hollow,
        "bodies": {
            name: body_of(reduced({name: grid}, hollow, pipes)[name], [name in s for s in states])
            for name, grid in meshes.items()
        },
        "pipes": {"field": EMPTIED, "levels": pipes.levels},
        "displacements": displacements(meshes, states),
        "fields": list(fields(run, topics, meshes, states)),
        "colours": colour_maps(topics),
        "factor": exaggeration(view, run.grids()),
        "cut": None if view.cut is None else float(view.cut),
        "direction": None if view.direction is None else [float(x) for x in view.direction],
    }


def first_grids(run: ReportedRun) -> Kept:
    """Return each body at the first time at which it is there."""
    found: Kept = {}
    for time in run.times:
        for name, grid in run.grids(time).items():
            found.setdefault(name, grid)
        if len(found) == len(run.bodies):
            break
    return found


def view_of(run: ReportedRun, state: State) -> View:
    """Return the view of all bodies, through the middle of the castings."""
    castings = [state[name] for name in run.freezing if name in state]
    return View.of(run.model, state.values(), castings=castings)


def scalars(grid: pyvista.UnstructuredGrid) -> set[str]:
    """Return the names of the scalar fields of a body."""
    arrays = [*grid.point_data.items(), *grid.cell_data.items()]
    return {name for name, values in arrays if values.ndim == 1}


def scalars_ever(meshes: Mapping[str, pyvista.UnstructuredGrid]) -> set[str]:
    """Return the names of all scalar fields of some bodies."""
    return {name for grid in meshes.values() for name in scalars(grid)}


def most_moments(
    meshes: Mapping[str, pyvista.UnstructuredGrid], topics: Sequence[Topic], hollow: bool
) -> int:
    """Return the number of moments that fit into the page."""
    each = sum(
        2 * (3 * grid.n_points + sum(
            grid.n_points if topic.field in grid.point_data else grid.n_cells
            for topic in topics
            if topic.field in grid.array_names and not topic.final
        ))
        for grid in meshes.values()
    )  # fmt: skip
    share = 4 if hollow else 1  # surfaces have fewer points than bodies
    return int(np.clip(share * LARGEST // max(each, 1), 2, MOST_MOMENTS))


def shown_times(times: Sequence[float], moments: Sequence[float], most: int) -> list[float]:
    """Return the times that are shown: the moments first, then others evenly between.

    Args:
        times: at which there are fields, ascending [s].
        moments: some of them at which something happens.
        most: their number, unless there are more moments.
    """
    found = {*moments, times[-1]}
    if len(found) < most:
        found.add(times[0])
    rest = [time for time in times if time not in found]
    count = min(max(most - len(found), 0), len(rest))
    if count:
        places = np.unique(np.linspace(0, len(rest) - 1, count).round().astype(int))
        found |= {rest[place] for place in places}
    return sorted(found)


def reduced(state: State, hollow: bool, pipes: Pipes) -> Kept:
    """Return bodies, or where these alone are shown their surfaces with the cells at pipes."""
    if not hollow:
        return dict(state)
    none = np.empty(0, dtype=np.int64)
    return {name: surface_of(grid, pipes.cells.get(name, none)) for name, grid in state.items()}


def body_of(grid: pyvista.UnstructuredGrid, there: Sequence[bool]) -> dict[str, Any]:
    """Return the mesh of a body, and at which moments it is there.

    Args:
        grid: cells of one kind, or triangles and behind them the tetrahedra at pipes.
        there: whether it is there at the moments.
    """
    kind = np.uint16 if grid.n_points < 2**16 else np.uint32
    first, *others = grid.cells_dict.items()
    return {
        "points": packed(np.asarray(grid.points, dtype=np.float32)),
        "cells": packed(first[1].astype(kind)),
        "inner": packed(others[0][1].astype(kind)) if others else None,
        "kind": pyvista.CellType(int(first[0])).name.lower(),
        "there": list(there),
    }


def displacements(
    meshes: Mapping[str, pyvista.UnstructuredGrid], states: Sequence[State]
) -> dict[str, Any]:
    """Return the displacements of the bodies that have them, (moments, 3 points)."""
    found = {}
    for name in meshes:
        if any("displacement" in s[name].point_data for s in states if name in s):
            found[name] = packed_values(series(name, "displacement", states))
    return found


def series(name: str, field: str, states: Sequence[State]) -> FloatArray:
    """Return a field of a body at all moments, (moments, values); not a number where it is gone."""
    size = next(s[name][field].size for s in states if name in s and field in s[name].array_names)
    found = np.full((len(states), size), np.nan)
    for row, state in zip(found, states, strict=True):
        if name in state and field in state[name].array_names:
            row[:] = np.asarray(state[name][field], dtype=np.float64).ravel()
    return found


def fields(
    run: ReportedRun,
    topics: Sequence[Topic],
    meshes: Mapping[str, pyvista.UnstructuredGrid],
    states: Sequence[State],
) -> Iterator[dict[str, Any]]:
    """Yield the fields that were written and vary.

    Args:
        run: the results.
        topics: how they are shown.
        meshes: the bodies.
        states: the bodies at their moments.
    """
    freezing = run.freezing or list(meshes)
    front = str(run.record.get("front", "f_s = 0.9"))
    for topic in topics:
        bodies = {}
        for name in meshes:
            shown = name in freezing or not topic.melting
            at = [s for s in states if name in s and topic.field in s[name].array_names]
            if not shown or not at:
                continue
            values = series(name, topic.field, at[-1:] if topic.final else states)
            limits = shown_range(values, topic)
            if limits is not None:
                bodies[name] = {
                    "in_cells": topic.field in at[0][name].cell_data,
                    "limits": limits,
                    "colours": topic.colours if name in freezing else topic.beside,
                    "values": packed_values(values),
                }
        if bodies:
            yield {
                "name": topic.field, "title": topic.title, "unit": topic.unit,
                "caption": topic.caption.replace("{front}", front), "factor": topic.factor,
                "front": topic.front, "final": topic.final, "bodies": bodies,
            }  # fmt: skip


SMALLEST_RANGE = 1e-6
"""Range of values, in the unit shown, below which colours would show round-off."""
ROUND_OFF = 1e-12
"""Share of the largest value below which the least one counts as zero."""


def shown_range(values: FloatArray, topic: Topic) -> tuple[float, float] | None:
    """Return the values at the ends of the colours; None: it does not vary."""
    finite = values[np.isfinite(values)]
    if finite.size == 0 or topic.factor * np.ptp(finite) < SMALLEST_RANGE:
        return None
    if topic.field == "solid_fraction":
        return 0.0, 1.0
    low, high = float(finite.min()), float(np.quantile(finite, topic.share))
    if topic.field == "gap" and high > 0.0:
        low = max(low, 0.0)  # closed pairs penetrate by what the equilibrium leaves
    return (0.0 if abs(low) < ROUND_OFF * abs(high) else low), high


def colour_maps(topics: Sequence[Topic]) -> dict[str, list[list[int]]]:
    """Return the colour maps of the fields, COLOURS times red, green and blue from 0 to 255."""
    names = sorted({name for topic in topics for name in (topic.colours, topic.beside)})
    at = np.linspace(0.0, 1.0, COLOURS)
    return {name: (255 * mpl.colormaps[name](at)[:, :3]).round().astype(int).tolist()
            for name in names}  # fmt: skip
