"""How long a run will take before it starts: by what runs of the same folder have taken.

Steps hardly depend on the mesh, and a step costs in proportion to its cells, so that the wall clock
time of a run that came to its end is scaled by the cells. Without such a run nothing is known.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import Any

from castx.case.case import STUDIES
from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.input.toml_text import parse_toml
from castx.input.units import seconds_text
from castx.results.files.folder import CASE, RECORD
from castx.results.files.reason import Reason
from castx.results.files.run_json import completed, number_of_cells, read_record

MOST_RUNS = 100
"""Results folders that are looked into."""
FAR = 10.0
"""Ratio of cells beyond which the time of another run says an order of magnitude at most."""


@dataclass(frozen=True)
class PastRun:
    """Run that has come to its end, with its cost.

    Attributes:
        results: name of its folder.
        case: name of its case.
        scheme: of its coupling.
        cells: of all bodies.
        steps: accepted ones.
        end: of the run [s].
        wall: wall clock time [s].
    """

    results: str
    case: str
    scheme: str
    cells: int
    steps: int
    end: float
    wall: float


def past_run(folder: Path, name: str) -> PastRun | None:
    """Return a run with its cost; None: it has not come to its end, or cannot be read.

    Args:
        folder: of its results.
        name: of the folder on the page.
    """
    try:
        record = completed(read_record(folder / RECORD))
    except CaseError:
        return None
    cells = number_of_cells(record)
    steps, wall = record["totals"]["steps"], record["wall"]
    if record["exit"]["reason"] != Reason.FINISHED or not (cells and steps and wall > 0.0):
        return None
    return PastRun(
        name, record["case"]["name"], record["scheme"], cells, steps, record["end"], wall
    )


def cells_of(folder: Path, geometry: Any) -> int:
    """Return the cells of a run that had a geometry; 0: it had another one, or there is none.

    Args:
        folder: of its results, of a run that may go on or have failed.
        geometry: table of the case file.
    """
    try:
        if json.loads((folder / CASE).read_text())["geometry"] != geometry:
            return 0
        return number_of_cells(completed(read_record(folder / RECORD)))
    except (OSError, ValueError, KeyError, TypeError):  # CaseError is a ValueError
        return 0


def nearest(runs: Iterable[PastRun], case: str, scheme: str, cells: int) -> PastRun | None:
    """Return the run that tells most of another one: of the same case, then of as many cells.

    Args:
        runs: of the folder.
        case: name of the case that is to run.
        scheme: of its coupling; runs of other schemes tell nothing.
        cells: of its mesh.
    """

    def distance(run: PastRun) -> tuple[bool, float, str]:
        return run.case != case, abs(math.log(cells / run.cells)), run.results

    alike = sorted((run for run in runs if run.scheme == scheme), key=distance)
    return alike[0] if alike else None


def expectation(
    text: str, path: Path, cells: int, results: Iterable[tuple[str, Path]]
) -> dict[str, Any]:
    """Return the time that a run will take, for JSON: seconds, or None, and where it is from.

    Args:
        text: of the case file.
        path: of the case file, beside which other files are.
        cells: of its mesh; 0: it has not been made on the page, but a run may have made it.
        results: names and paths of the results folders that are known.
    """
    try:
        content = {key: value for key, value in parse_toml(text).items() if key not in STUDIES}
        case = read_case(content, path)
    except ValueError:  # of which CaseError is one
        return {"seconds": None, "text": ""}
    listed = list(results)[:MOST_RUNS]
    own = [folder for _, folder in listed if folder == case.output.folder]
    if not cells and own:
        cells = cells_of(own[0], case.content.get("geometry"))
    if not cells:
        return _unknown("make the mesh first, in the tab Mesh, which tells its cells")
    found = [past_run(folder, name) for name, folder in listed]
    known = [run for run in found if run is not None]
    like = nearest(known, case.name, case.coupling.scheme, cells)
    if like is None:
        what = f" with the scheme {case.coupling.scheme}" if known else ""
        return _unknown(f"no run of this folder{what} has come to its end yet")
    seconds = like.wall * cells / like.cells
    so = "" if like.case == case.name else ", of another case,"
    rough = "" if 1.0 / FAR < cells / like.cells < FAR else "; by so many other cells, a guess"
    return {
        "seconds": seconds,
        "text": (
            f"about {_words(seconds)} for {cells} cells: {like.results}{so} took "
            f"{_words(like.wall)} for {like.cells}, in {like.steps} steps to "
            f"{seconds_text(like.end)}{rough}"
        ),
    }


def _unknown(why: str) -> dict[str, Any]:
    return {"seconds": None, "text": f"unknown: {why}"}


def _words(seconds: float) -> str:
    """Return a wall clock time as 0:01:40, with no more digits than are known."""
    step = 1.0 if seconds < 100.0 else 10.0 if seconds < 1000.0 else 60.0
    return str(timedelta(seconds=max(step * round(seconds / step), 1.0)))
