"""The thermal history of a casting as tables: at its nodes, and for ExaCA on a Cartesian grid."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.handover.body_state import BodyState
from castx.handover.text import write_lines
from castx.results.states.quantities import PASSING

LIQUIDUS, SOLIDUS = f"{PASSING}0.0", f"{PASSING}1.0"
NODAL = {
    "t_liquidus": LIQUIDUS,
    "t_solidus": SOLIDUS,
    "G": "gradient",
    "R": "front_speed",
    "cooling_rate": "cooling_rate",
    "arm_spacing": "arm_spacing",
}
"""Columns of the table of nodes and the fields behind them."""
MOST_POINTS = 10**9
AT_ONCE = 10**6
"""Points of a grid that are sampled together."""


def write_nodes(state: BodyState, path: Path) -> int:
    """Write the thermal history at the nodes as CSV, and return the number of rows.

    Columns x, y, z [m], t_liquidus, t_solidus [s] from pouring, G [K/m], R [m/s], cooling_rate
    [K/s], arm_spacing [m]; "nan" where a quantity does not exist.

    Raises:
        CaseError: a field was not written, or the disk does not take the file.
    """
    state.need(list(NODAL.values()), "the table of nodes")
    columns = [state.values(name) for name in NODAL.values()]
    table = np.column_stack([state.points, *columns])
    write_lines(path, _rows(["x", "y", "z", *NODAL], table))
    return len(table)


def write_exaca(state: BodyState, path: Path, spacing: float) -> tuple[int, int]:
    """Write times and cooling rates on a Cartesian grid for ExaCA.

    Columns x, y, z [m], tm, tl [s], cr [K/s]: the metal is molten from the start, tm = 0, tl is
    when the liquidus passes from then on. Plane and axisymmetric models lie in z = 0.

    Args:
        state: the body at the last moment.
        path: of the file.
        spacing: of the grid [m].

    Returns:
        Number of rows, and of grid points in the body that are left out since they have not begun
        to freeze or have no cooling rate.

    Raises:
        CaseError: a field was not written, the grid is too fine, or the disk does not take it.
    """
    state.need([LIQUIDUS, "cooling_rate"], "the table for ExaCA")
    bounds = np.asarray(state.grid.bounds).reshape(3, 2)
    axes = [low + spacing * np.arange(int((high - low) / spacing + 1e-9) + 1)
            for low, high in bounds]  # fmt: skip
    count = int(np.prod([float(len(axis)) for axis in axes]))
    if count > MOST_POINTS:
        raise CaseError(
            f"a spacing of {spacing:g} m makes {count:.3g} points, at most {MOST_POINTS:.0e} are "
            "allowed; take a larger one, or a part of the casting"
        )
    inside, rows = 0, 0

    def blocks() -> Iterator[str]:
        nonlocal inside, rows
        yield "x,y,z,tm,tl,cr"
        for places in _blocks(axes):
            found, points = _sampled(state, places)
            inside, rows = inside + points, rows + len(found)
            yield from (",".join(f"{value:.10g}" for value in row) for row in found)

    write_lines(path, blocks())
    return rows, inside - rows


def _blocks(axes: list[FloatArray]) -> Iterator[FloatArray]:
    """Yield the points of a grid in blocks of whole layers, (points, 3)."""
    x, y, z = axes
    layer = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    for height in z:
        for start in range(0, len(layer), AT_ONCE):
            part = layer[start : start + AT_ONCE]
            yield np.column_stack([part, np.full(len(part), height)])


def _sampled(state: BodyState, places: FloatArray) -> tuple[FloatArray, int]:
    """Return the rows of points that lie in the body and have frozen, and how many lie in it."""
    cloud = pyvista.PolyData(places).sample(state.grid)
    there = np.asarray(cloud["vtkValidPointMask"], dtype=bool)
    times, rates = np.asarray(cloud[LIQUIDUS]), np.asarray(cloud["cooling_rate"])
    frozen = there & np.isfinite(times) & np.isfinite(rates) & (rates > 0.0)
    rows = np.column_stack([places, np.zeros(len(places)), times, rates])
    return rows[frozen], int(there.sum())


def _rows(names: list[str], table: FloatArray) -> Iterator[str]:
    yield ",".join(names)
    for values in table:
        yield ",".join(f"{value:.15g}" for value in values)
