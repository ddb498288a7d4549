"""Strain that the mush of a body gains across the temperature gradient while it freezes.

Elastic and inelastic strain is what the metal has beyond its thermal strain: that of the cells,
from one accepted step to the next. A node takes the mean over the cells round it that have a
skeleton, by volume, for the part of the step in which it is in a range of solid fractions, without
its parts along the gradient.

The direction of the gradient is the main one of Σ V g gᵀ over these cells. Near an insulated
surface temperatures differ so little that the gradient of a single triangle may point anywhere; the
sum does not, and fronts that meet do not cancel in it. Its first two eigenvalues λ say how far the
cells have one direction: the parts along it are left out by the share (λ_1 - λ_2)/λ_1, and where
there is no gradient, or none of one direction, all directions count.

What the skeleton shrinks while it freezes is kept beside it: to whom the suction by shrinkage is
another term, it is no strain.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Protocol

import numpy as np
from dolfinx import la

from castx.arrays import FloatArray
from castx.foundry.cracking import principal_values, strain_across
from castx.foundry.front.gradients import midpoint_gradients
from castx.foundry.front.windows import Window
from castx.foundry.stress.stage_ends import SolidState
from castx.solvers.counters import StepCounters
from castx.stateful import Arrays, Saved, number

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

COMPONENTS = 6
"""Of a strain, after which the volumetric one of the shrinkage follows."""
FLAT = 1e-9
"""Difference within a cell, relative to that of a window, which counts as no gradient."""

Shrinking = Callable[[FloatArray], FloatArray]
"""Volumetric strain by which a skeleton has shrunk at solid fractions."""


State = tuple[FloatArray, FloatArray]
"""Followed values of the nodes (nodes,), strains and shrinkage of the cells (cells, 7)."""


class CoolingState(SolidState, Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def counters(self) -> StepCounters:
        """Effort of the step, and its size."""


class FallingQuantity(Protocol):
    """Quantity of the nodes that falls while they freeze, and the range of its values."""

    @property
    def name(self) -> str:
        """Of the nodal field, "enthalpy" or "temperature"."""

    @property
    def windows(self) -> Mapping[float, Window]:
        """Ranges by the solid fraction at their ends."""

    @property
    def shrinking(self) -> Shrinking:
        """Strain of the skeleton by freezing."""


class BodyStrains:
    """The strain gained in the mush of one body.

    Args:
        body: its mesh.
        followed: the ranges of solid fractions.
    """

    def __init__(self, body: BodyMesh, followed: FallingQuantity) -> None:
        self._body, self._followed = body, followed
        self._windows = tuple(followed.windows.values())
        self._index = {fraction: i for i, fraction in enumerate(followed.windows)}
        self._cell_nodes = body.nodes.dofmap.list
        owned = body.cell_numbering.owned
        gradients, sizes = midpoint_gradients(body.nodes, body.points[self._cell_nodes])
        self._gradients, self._sizes = gradients[:owned], sizes[:owned]
        self._owned, nodes = slice(owned), len(body.parent_vertices)
        shape = len(self._windows), nodes
        self._strain: FloatArray = np.full((*shape, COMPONENTS + 1), np.nan)
        self._duration: FloatArray = np.full(shape, np.nan)
        self._time = np.nan
        none: State = (np.zeros(nodes), np.zeros((len(self._cell_nodes), COMPONENTS + 1)))
        self._last: State = none
        self._first: State = none

    def update(self, snapshot: CoolingState) -> None:
        """Take over the state after an accepted step; collective."""
        name = self._body.name
        now = self._state(snapshot)
        if name in snapshot.process.renewed:
            self._strain[:], self._duration[:] = np.nan, np.nan
            self._time, self._last = snapshot.time - snapshot.counters.step, self._first
        if np.isnan(self._time):
            self._first = now
        else:
            solid = snapshot.cellwise(name, "coherent")[self._owned]
            self._gain(now, snapshot.time - self._time, solid)
        self._time, self._last = snapshot.time, now

    def _state(self, snapshot: CoolingState) -> State:
        """Return the followed values of the nodes, and strains and shrinkage of the cells."""
        name = self._body.name
        values = snapshot.nodal(name, self._followed.name).copy()
        fraction = snapshot.nodal(name, "solid_fraction")[self._cell_nodes].mean(axis=1)
        strain = snapshot.cellwise(name, "mechanical_strain")
        return values, np.column_stack([strain, self._followed.shrinking(fraction)])

    def _gain(self, now: State, step: float, solid: FloatArray) -> None:
        start, end = self._last[0], now[0]
        slopes = self._slopes(0.5 * (start + end))
        gained, directions = self._at_nodes((now[1] - self._last[1])[self._owned], slopes, solid)
        gained[:, :COMPONENTS] = strain_beside(gained[:, :COMPONENTS], directions)
        for index, window in enumerate(self._windows):
            begun = window.enters(start, end)
            molten = end >= window.begin
            share = window.share(start, end)
            for kept, more in (
                (self._strain[index], share[:, None] * gained),
                (self._duration[index], share * step),
            ):
                kept[begun] = 0.0
                kept += more
                kept[molten] = np.nan

    def _slopes(self, values: FloatArray) -> FloatArray:
        """Return the gradients of the owned cells, zero where nearly flat, (cells, dimension).

        Args:
            values: that fall while nodes freeze, (nodes,).
        """
        corners = values[self._cell_nodes[self._owned]]
        slopes: FloatArray = np.einsum("cak,ca->ck", self._gradients, corners)
        width = max(window.begin - window.end for window in self._windows)
        slopes[np.ptp(corners, axis=1) <= FLAT * width] = 0.0
        return slopes

    def _at_nodes(
        self, change: FloatArray, slopes: FloatArray, solid: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return means of changes and of g gᵀ over the solid cells round the nodes; collective.

        Zero where no cell is solid.

        Args:
            change: of strains and shrinkage of the owned cells, (cells, 7).
            slopes: g of these cells, (cells, dimension).
            solid: whether they have a skeleton, (cells,).

        Returns:
            (nodes, 7), (nodes, dimension, dimension).
        """
        dimension, weights = slopes.shape[1], (self._sizes * solid)[:, None]
        squares = (slopes[:, :, None] * slopes[:, None, :]).reshape(-1, dimension**2)
        columns = np.hstack([change * weights, squares * weights, weights])
        vector = la.vector(self._body.nodes.dofmap.index_map, columns.shape[1])
        sums = vector.array.reshape(-1, columns.shape[1])
        sums[:] = 0.0
        for corner in self._cell_nodes[self._owned].T:
            np.add.at(sums, corner, columns)
        vector.scatter_reverse(la.InsertMode.add)
        vector.scatter_forward()
        total = sums[:, -1:]
        means = np.zeros((len(sums), columns.shape[1] - 1))
        np.divide(sums[:, :-1], total, out=means, where=total > 0.0)
        gained, directions = means[:, : COMPONENTS + 1], means[:, COMPONENTS + 1 :]
        return gained, directions.reshape(-1, dimension, dimension)

    def _gained(self, until: float) -> tuple[FloatArray, FloatArray]:
        """Return strain (nodes, 7) and time [s] of a range, not a number if it is not passed."""
        index = self._index[until]
        there = self._last[0] <= self._windows[index].end
        strain = np.where(there[:, None], self._strain[index], np.nan)
        return strain, np.where(there, self._duration[index], np.nan)

    def largest(self, until: float) -> FloatArray:
        """Return the largest principal strain gained across the gradient, not below 0, (nodes,).

        Args:
            until: solid fraction at which the range ends.
        """
        return largest_principal(self._gained(until)[0][:, :COMPONENTS])

    def largest_beside_shrinkage(self, until: float) -> FloatArray:
        """Return the same as `largest`, without the shrinkage of the skeleton."""
        strain = self._gained(until)[0]
        shrunk = strain[:, COMPONENTS:] / 3.0
        direct = strain[:, :3] + shrunk
        return largest_principal(np.column_stack([direct, strain[:, 3:COMPONENTS]]))

    def duration(self, until: float) -> FloatArray:
        """Return the time in which nodes were in a range [s], (nodes,)."""
        return self._gained(until)[1]

    def saved(self) -> dict[str, Saved]:
        """Return accumulated strains and durations, the last state and the first one."""
        nodes, cells = self._body.node_numbering, self._body.cell_numbering
        found = {"time": number(self._time)}
        for when, (values, strain) in (("last", self._last), ("first", self._first)):
            found[f"{when} values"] = Saved(values, nodes)
            found[f"{when} strain"] = Saved(strain, cells)
        for fraction, index in self._index.items():
            found[f"strain until {fraction!r}"] = Saved(self._strain[index], nodes)
            found[f"duration until {fraction!r}"] = Saved(self._duration[index], nodes)
        return found

    def restore(self, arrays: Arrays) -> None:
        """Restore it; a range that was not followed before is followed from now on."""
        self._time = float(arrays["time"])
        self._last, self._first = (
            (arrays[f"{when} values"], arrays[f"{when} strain"]) for when in ("last", "first")
        )
        for fraction, index in self._index.items():
            if f"strain until {fraction!r}" in arrays:
                self._strain[index] = arrays[f"strain until {fraction!r}"]
                self._duration[index] = arrays[f"duration until {fraction!r}"]


def strain_beside(strain: FloatArray, directions: FloatArray) -> FloatArray:
    """Return strains without their parts along gradients of which the mean g gᵀ is given.

    Args:
        strain: (n, 6).
        directions: mean g gᵀ, (n, dimension, dimension).
    """
    sizes, vectors = np.linalg.eigh(directions)
    first, second = sizes[:, -1:], np.maximum(sizes[:, -2:-1], 0.0)
    share = np.divide(first - second, first, out=np.zeros_like(first), where=first > 0.0)
    across = strain_across(strain, vectors[:, :, -1])
    return np.asarray(share * across + (1.0 - share) * strain)


def largest_principal(strain: FloatArray) -> FloatArray:
    """Return the largest principal values of strains (n, 6), not below zero, (n,)."""
    found: FloatArray = np.full(len(strain), np.nan)
    known = np.isfinite(strain).all(axis=1)
    found[known] = np.maximum(principal_values(strain[known])[:, 0], 0.0)
    return found
