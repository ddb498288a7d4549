"""Coarse meshes of a CAD part, of which nothing is known yet, for its first case."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from castx.case.cad.geometry import CadGeometry
from castx.case.cad.template import NewCase
from castx.case.processes.plan import rounded
from castx.domain.cad.guarded import SizesError, meshed_apart
from castx.errors import MeshError
from castx.meshes.cad.description import CadFile, CadPart
from castx.meshes.cad.report import Report

GROWTH: float = CadGeometry.model_fields["growth"].default
"""By how much sizes grow over a distance if a case says nothing else."""
BUDGET = 60.0
"""Time for the mesh with one cell across walls, and for reading a part before [s]."""
LAST_BUDGET = 600.0
"""Time for the coarsest mesh [s]."""
TOLERANCE = 1e-4
"""Width up to which faces are removed where small ones ask for too many cells [m]."""
NARROWEST = (1e-3, 3e-3)
"""Widths of the narrowest faces that are left in where the others ask for too many cells [m]."""
CURE = (
    f"It is refused without what is narrower than {1e3 * NARROWEST[-1]:g} mm too, as far as that "
    "can be left out: suppress grooves, threads, roundings and slivers that are not cast in CAD, "
    "and export the part again"
)
"""What helps where nothing that is tried makes a mesh."""
FIRST_CELLS = 1e5
"""Cells of a first mesh, with which a step takes seconds."""
AFFORDABLE = 10_000
"""Cells of a first mesh beyond which those away from walls and faces grow faster; beyond twice as
many walls are taken as they come."""
GROWN = 1.0
"""By how much their sizes grow then over a distance."""
WORTH = 0.9
"""Share of the cells that a faster growth has to leave at most, else cells grow as usual."""

Say = Callable[[str], None]


@dataclass(frozen=True)
class Attempt:
    """A way to mesh a part coarsely.

    Attributes:
        said: in words, when the one before has made no mesh.
        changes: of a part that is taken as it comes.
        patience: time that it may take [s].
    """

    said: str
    changes: dict[str, Any] = field(default_factory=dict)
    patience: float = BUDGET


@dataclass(frozen=True)
class FirstMesh:
    """A coarse mesh.

    Attributes:
        report: of the mesh.
        part: of which it is.
        attempt: number of the attempt that has made it.
    """

    report: Report
    part: CadPart
    attempt: int = 0


def attempts() -> Sequence[Attempt]:
    """Return the ways to mesh a part that are tried in turn until one makes a mesh."""
    narrow = "without grooves, threads and roundings of less than {:g} mm"
    coarse = {"most_cells": FIRST_CELLS}
    return (
        Attempt("one cell across each wall", {"across": 1, **coarse}),
        Attempt("walls as they come", coarse),
        Attempt(
            f"without faces narrower than {1e3 * TOLERANCE:g} mm",
            {"tolerance": TOLERANCE, **coarse},
        ),
        *(
            Attempt(narrow.format(1e3 * width), {"narrowest": width, **coarse})
            for width in NARROWEST[:-1]
        ),
        Attempt(narrow.format(1e3 * NARROWEST[-1]), {"narrowest": NARROWEST[-1]}, LAST_BUDGET),
    )


def part_as_it_comes(cad_file: Path) -> CadPart:
    """Return a CAD file as a part with the coarsest cells."""
    return CadPart((CadFile(str(cad_file)),), math.inf, across=0, curvature=8.0)


def survey(part: CadPart, say: Say, first: int = 0) -> FirstMesh:
    """Return the first mesh that one of `attempts` makes.

    Args:
        part: as it comes.
        say: gets lines about what goes on.
        first: number of the attempt to begin with.

    Raises:
        MeshError: none does, or the file cannot be read.
    """
    ways = attempts()
    for number, way in enumerate(ways[first:], first):
        tried = replace(part, **way.changes)
        try:
            return FirstMesh(meshed(tried, way.patience), tried, number)
        except SizesError as error:
            if number + 1 == len(ways):
                raise MeshError(f"{error}. {CURE}") from None
        say(f"that makes no first mesh; next: {ways[number + 1].said}")
    raise AssertionError("attempts end with one that returns or raises")


def meshed(part: CadPart, patience: float) -> Report:
    """Return the report of a mesh that is not kept, arguments and errors as of `meshed_apart`."""
    with TemporaryDirectory() as folder:
        return meshed_apart(part, Path(folder) / "mesh.msh", patience)


def affordable(mesh: FirstMesh, say: Say) -> FirstMesh:
    """Return a mesh with fewer cells where there are many.

    Cells away from walls and faces grow faster first. Where that leaves twice as many as a first
    run can afford, walls are taken as they come: they have one cell across all the same, and bend
    no worse with one that is longer.

    Args:
        mesh: as it is.
        say: gets lines about what goes on.
    """
    if mesh.report.quality.cells > AFFORDABLE:
        text = "by which walls and faces keep theirs, and those in the mould are larger"
        mesh = _with_fewer(mesh, replace(mesh.part, growth=GROWN), say, f"growth = 1, {text}")
    if mesh.report.quality.cells > 2 * AFFORDABLE and mesh.part.across > 0:
        text = "by which walls have one across all the same, but longer ones"
        mesh = _with_fewer(mesh, replace(mesh.part, across=0), say, f"across = 0, {text}")
    return mesh


def _with_fewer(mesh: FirstMesh, other: CadPart, say: Say, text: str) -> FirstMesh:
    """Return the mesh of another part, if that has far fewer cells."""
    cells = mesh.report.quality.cells
    try:
        found = meshed(other, BUDGET)
    except SizesError:
        return mesh
    if found.quality.cells > WORTH * cells:
        return mesh
    say(f"{cells} cells; {found.quality.cells} with {text}")
    return FirstMesh(found, other, mesh.attempt)


def as_case(
    mesh: FirstMesh, file: str, margin: float | None = None, text: str | None = None
) -> NewCase:
    """Return the data of a new case by its coarse mesh.

    Args:
        mesh: the mesh.
        file: as the case names it.
        margin: of a mould that is made [m].
        text: of such a mould.
    """
    report, made = mesh.report, mesh.part
    between = [(measure.name.split("/"), measure.cad) for measure in report.interfaces]
    return NewCase(
        file,
        rounded(report.size),
        margin,
        tuple((measure.name, measure.cad) for measure in report.bodies),
        tuple((bodies[0], bodies[1], area) for bodies, area in between),
        tuple((measure.name, measure.cad) for measure in report.surfaces),
        round(made.across),
        mould=text,
        tolerance=made.tolerance if made.tolerance == TOLERANCE else None,
        narrowest=made.narrowest or None,
        growth=None if made.growth == GROWTH else made.growth,
        boxes=report.boxes,
    )
