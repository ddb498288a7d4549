"""The scene of the last moment of a run: the surfaces of its bodies, coloured by a field."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.report.browser_scene import colour_maps, scalars, shown_range
from castx.report.packing import packed
from castx.report.pictures import outer_faces
from castx.report.topics import TOPICS, Topic, topics_of
from castx.results.reading import Results
from castx.results.sunk_shape import drawn_body

Answer = dict[str, Any]
FIRST = "temperature"
"""Field that is shown unless another one is asked for."""


def moment_scene(folder: Path, field: str) -> Answer:
    """Return the last moment of a run for a page, for JSON.

    Args:
        folder: of the results, of a run that may go on.
        field: name of the one that is shown; another one if it was not written.

    Raises:
        CaseError: there are no results or no fields.
    """
    run = Results(folder)
    time = run.times[-1]
    grids = run.grids(time)
    names = {name for grid in grids.values() for name in scalars(grid)}
    topics = {topic.field: topic for topic in topics_of(names) if not topic.final}
    topic = topics.get(field) or topics.get(FIRST) or next(iter(topics.values()))
    drawn = {
        name: surface_values(drawn_body(grid, run.model, topic.field), topic)
        for name, grid in grids.items()
    }
    counts = [len(triangles) for triangles, _ in drawn.values()]
    return {
        "time": time,
        "flat": run.model != "3d",
        "fields": [{"name": t.field, "title": t.label} for t in topics.values()],
        "field": topic.field, "title": topic.label, "factor": topic.factor,
        "colours": topic.colours, "maps": colour_maps(TOPICS),
        "bodies": list(drawn),
        "freezing": [name for name in run.freezing if name in drawn],
        "limits": limits_of(grids, topic, run.freezing),
        "counts": packed(np.array(counts, dtype=np.uint32)),
        "points": packed(np.concatenate([t for t, _ in drawn.values()]).astype(np.float32).ravel()),
        "values": packed(np.concatenate([v for _, v in drawn.values()]).astype(np.float32).ravel()),
    }  # fmt: skip


def surface_values(grid: pyvista.UnstructuredGrid, topic: Topic) -> tuple[FloatArray, FloatArray]:
    """Return the triangles of the surface of a body and the field at their corners.

    Args:
        grid: the body.
        topic: the field; a body without it has a value beyond all others.

    Returns:
        (triangles, 3 corners, 3) [m] and (triangles, 3).
    """
    surface = outer_faces(grid).triangulate()
    corners = surface.faces.reshape(-1, 4)[:, 1:]
    points = np.asarray(surface.points, dtype=np.float64)[corners]
    if topic.field in surface.point_data:
        values = np.asarray(surface.point_data[topic.field], dtype=np.float64)[corners]
    elif topic.field in surface.cell_data:
        cells = np.asarray(surface.cell_data[topic.field], dtype=np.float64)
        values = np.repeat(cells[:, None], 3, axis=1)
    else:
        values = np.full(corners.shape, np.nan)
    return points, np.where(np.isfinite(values), values, UNKNOWN)


UNKNOWN = 3.3e38
"""Value where a field is not, beyond what the page draws in colours."""


def limits_of(
    grids: dict[str, pyvista.UnstructuredGrid], topic: Topic, freezing: list[str]
) -> tuple[float, float]:
    """Return the values at the ends of the colours: of the castings, if they have the field.

    Args:
        grids: the bodies.
        topic: the field.
        freezing: names of the castings.
    """
    having = {name: grid for name, grid in grids.items() if topic.field in grid.array_names}
    cast = {name: grid for name, grid in having.items() if name in freezing} or having
    found = [np.asarray(grid[topic.field], dtype=np.float64).ravel() for grid in cast.values()]
    values = np.concatenate(found) if found else np.zeros(1)
    limits = shown_range(values, topic)
    if limits is None:
        middle = float(values[np.isfinite(values)].mean()) if np.isfinite(values).any() else 0.0
        return middle - 0.5 / topic.factor, middle + 0.5 / topic.factor
    return limits
