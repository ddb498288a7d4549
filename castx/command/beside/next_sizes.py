"""Sizes of the cells of the next mesh, by the errors that a run has written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.case.case import Case
from castx.case.fields.heat import FLUX_ERROR
from castx.case.fields.stress import STRESS_ERROR
from castx.case.reading.adapted import error_fields
from castx.discretisation.new_sizes import ErringMesh, simplex_volumes
from castx.domain.cad.size_map import write_size_map
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.meshes.cad.curvature import FILLING
from castx.results.reading import Results

MORE_CELLS = 2.0
"""Cells of the next mesh over those of the present one."""
MADE = 0.57
"""Cells that gmsh makes of sizes that change over space, over those that they stand for: 0.54 to
0.60 in a lug and its die."""
COLD = 20.0
"""Temperature of the stiffness and conductivity by which bodies are weighed [°C]."""
SAME_PLACE = 1e-9
"""Distance of two points that are one, over the extent of all bodies."""


@dataclass(frozen=True)
class _BodyCells:
    """Cells of one body at the last moment at which it was there.

    Attributes:
        points: (points, 3) [m].
        cells: (cells, 4).
        errors: squared ones of stress and of heat flux by the names of their fields, each over the
            whole body in units of energy, (cells,).
    """

    points: FloatArray
    cells: LongArray
    errors: dict[str, FloatArray]


def write_next_sizes(case: Case, path: Path) -> None:
    """Write sizes for the next mesh of a case; call it on one rank only.

    Errors are those of the stress at the end and of the heat flux over the run, in the norms of
    energy, ∫ |δσ|²/E dV and ∫ |δq|²/k dV. Both count alike: each is a share of the sum of its own
    over all bodies.

    Args:
        case: that has run, with its errors among the fields.
        path: of the file.

    Raises:
        CaseError: the results cannot be read.
    """
    results = Results(case.output.folder)
    found = [_cells_of(results, case, body) for body in results.bodies]
    offsets = np.cumsum([0, *(len(body.points) for body in found)])
    points = np.concatenate([body.points for body in found])
    cells = np.concatenate([b.cells + n for b, n in zip(found, offsets, strict=False)])
    squares = np.mean([_shares(found, name) for name in error_fields(case)], axis=0)
    points, cells = _joined(points, cells)
    cad = case.geometry.cad
    assert cad is not None
    mesh = ErringMesh(points, cells, squares, FILLING, cad.growth)
    write_size_map(path, points, cells, mesh.next_sizes(MORE_CELLS / MADE))


def _cells_of(results: Results, case: Case, body: str) -> _BodyCells:
    (named,) = (each for each in case.bodies if each.name == body)
    material = find_material(named.material, case.materials)
    last = max(time for time in results.times if body in results.bodies_at(time))
    fields = {name: results.field(name, body, last) for name in error_fields(case)}
    mesh = next(iter(fields.values()))
    volumes = simplex_volumes(mesh.points, mesh.cells)
    errors = {
        name: np.asarray(volumes * field.values**2 / _WEIGHTS[name](material))
        for name, field in fields.items()
    }
    return _BodyCells(mesh.points, mesh.cells, errors)


def _stiffness(material: Material) -> float:
    assert material.young_modulus is not None
    return float(material.young_modulus(COLD))


_WEIGHTS: dict[str, Callable[[Material], float]] = {
    STRESS_ERROR: _stiffness,
    FLUX_ERROR: lambda material: float(material.conductivity.solid(COLD)),
}
"""What turns the square of an error in a cell into energy."""


def _shares(bodies: list[_BodyCells], name: str) -> FloatArray:
    """Return the shares of cells in an error of all bodies."""
    squares = np.concatenate([body.errors[name] for body in bodies])
    whole = squares.sum()
    return np.asarray(squares / whole if whole > 0.0 else squares)


def _joined(points: FloatArray, cells: LongArray) -> tuple[FloatArray, LongArray]:
    """Return points without repetitions, which bodies have where they touch, and their cells."""
    step = SAME_PLACE * float(np.ptp(points, axis=0).max())
    _, first, number = np.unique(
        np.round(points / step).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return points[first], number.reshape(-1)[cells]
