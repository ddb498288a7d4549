"""Liquid at the wall: pairs that resist opening, since metal that does not bear follows the wall.

A liquid cannot leave a wall: the air would have to pass through it, and what the wall leaves free
is filled by metal that flows there. Solid that is pulled lets go, where a void opens in what is
left of the liquid. So a closed pair bears a pull,

    −w p_c ≤ (1 − w) p_v,

with p_c the contact pressure over the facets round the pair (`kinematics.facet_means`), p_v the
depression at which melt lets go (`Material.wall_suction`) and w the share of the metal of its node
that bears stress (`Material.bearing_share`), of two bodies the smaller one. That share of a pull
comes from the solid; the rest is due to the viscosity of the liquid, a number that keeps the
problem solvable. The solid surface, w = 1, leaves its wall without being pulled, a liquid never
does, and everything is continuous between them. A pair that has let go is free until it closes by
itself; where all metal round it, over its facets, has melted again it closes at once. A single node
that melts behind its gap would freeze at the wall and let go within one step. A pair that was given
a gap that is positive without any displacement is never held: there is no metal at that wall.

Where melt flows through the mush its pressure decides, see `castx.mechanics.mush.wall`. That alone
brings back what melts again, too: a wall draws nothing across a gap, and a skin that came back at
once would open pores behind it, by which it lets go in the next step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.facet_means import FacetMeans
from castx.contact.kinematics.gaps import Gaps
from castx.contact.liquid_column import column_pressure
from castx.mechanics.body import BodyMechanics
from castx.mechanics.liquid.regions import CellRegions
from castx.solvers.layout import Layout
from castx.solvers.remote_entries import RemoteEntries


@dataclass(frozen=True)
class _Side:
    """The nodes of one body at the rows of an interface.

    Attributes:
        rows: of the interface.
        entries: entries of the first unknown of the nodes, one object for each corner of a facet.
        weights: of these nodes, (rows, corners).
    """

    rows: slice
    entries: tuple[RemoteEntries, ...]
    weights: FloatArray

    def get(self, vector: PETSc.Vec) -> FloatArray:
        """Return the values at the nodes, shape (rows, corners); collective."""
        return np.column_stack([entry.get(vector) for entry in self.entries])


class LiquidSkin:
    """Finds the pulls that liquid bears at the pairs, and the pressure of its column there.

    Args:
        layout: numbering of the unknowns of all bodies.
        bodies: in the order of the layout.
        gaps: the pairs of all interfaces.
    """

    def __init__(self, layout: Layout, bodies: Sequence[BodyMechanics], gaps: Gaps) -> None:
        self._layout, self._bodies = layout, list(bodies)
        self._regions = {b.name: CellRegions(b.mesh) for b in bodies if not b.is_compressible}
        self._can_hold = gaps.free & (gaps.at_rest <= 0.0)
        self._areas, self._slices = gaps.areas, gaps.slices
        self._values = layout.create_vector()
        self._sides = list(self._find_sides(gaps))
        any_facets = any(interface.facets is not None for interface in gaps.interfaces)
        self._means = FacetMeans(layout.comm, gaps) if any_facets else None

    def _find_sides(self, gaps: Gaps) -> Iterator[_Side]:
        numbers = {b.name: n for n, b in enumerate(self._bodies) if b.name in self._regions}
        for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
            pairs, index = interface.pairs, interface.index
            nodes, weights = pairs.partners
            own = (pairs.secondary, pairs.secondary_nodes[:, None], np.ones((len(nodes), 1)))
            for name, corners, shares in (own, (pairs.primary, nodes, weights)):
                if name in numbers:
                    dofs = [self._layout.dofs(numbers[name], n) for n in corners[index].T]
                    entries = tuple(RemoteEntries(self._values, of) for of in dofs)
                    yield _Side(part, entries, shares[index])

    def pulls(self) -> tuple[FloatArray, BoolArray]:
        """Return the largest pulls of the rows in the present state of the bodies; collective.

        Returns:
            Pulls that liquid bears [N], shape (rows,), infinite where no metal of one side bears
            stress, and whether metal comes back to the wall there from any gap.
        """
        pulls = [_pressures_of_pull(body) for body in self._bodies]
        returns = [
            np.isinf(pull) & (body.formulation.wall_melt is None)
            for body, pull in zip(self._bodies, pulls, strict=True)
        ]
        largest, molten = self._largest(pulls), self._largest(returns) > 0.0
        if self._means is not None:
            molten = self._means.amid(molten)
        return np.where(self._can_hold, largest * self._areas, 0.0), self._can_hold & molten

    def _largest(self, nodal: Sequence[FloatArray | BoolArray]) -> FloatArray:
        """Return nodal values at all rows, of two bodies the larger one, (rows,); collective.

        Where a node faces several the smallest of theirs counts.
        """
        found = np.zeros(len(self._can_hold))
        self._fill(nodal)
        for side in self._sides:
            values, own = side.get(self._values), side.weights > 0.0
            here = np.where(own, values, np.inf).min(axis=1)
            found[side.rows] = np.maximum(found[side.rows], here)
        return found

    def felt(self, forces: FloatArray, held: BoolArray) -> FloatArray:
        """Return contact forces as liquid at the wall feels them: means round pairs; collective.

        Args:
            forces: of the pairs [N], compressive positive, shape (rows,).
            held: closed pairs that liquid holds, shape (rows,).
        """
        return forces if self._means is None else self._means.forces(forces, held)

    def pressures(self) -> FloatArray:
        """Return the pressure of the liquid column at all rows [Pa], (rows,); collective.

        It rests below the highest point of the liquid that is connected to the node, and is zero
        where there is none.
        """
        found = np.zeros(len(self._can_hold))
        if not self._sides or not any(body.loads.weighs for body in self._bodies):
            return found
        self._fill([self._column(body) for body in self._bodies])
        for side in self._sides:
            column = np.sum(side.get(self._values) * side.weights, axis=1)
            found[side.rows] = np.maximum(found[side.rows], column)
        return found

    def growth(self, closed: BoolArray) -> float:
        """Return the largest mean change over an interface of what bears at its pairs; collective.

        It is the change of w in the trial step, over the areas of pairs, as a share of them all.

        Args:
            closed: pairs that were closed at the start of the step, shape (rows,).
        """
        change = np.zeros(len(self._can_hold))
        self._fill([_growth(body) for body in self._bodies])
        for side in self._sides:
            values = np.sum(side.get(self._values) * side.weights, axis=1)
            change[side.rows] = np.maximum(change[side.rows], values)
        sums = np.array(
            [
                [(self._areas * change)[part][closed[part]].sum(), self._areas[part].sum()]
                for part in self._slices
            ]
        ).reshape(-1, 2)
        moved, whole = self._layout.comm.allreduce(sums).T
        return float(np.max(moved / np.where(whole > 0, whole, 1.0), initial=0.0))

    def _fill(self, nodal: Sequence[FloatArray | BoolArray]) -> None:
        """Give the first unknown of each node a value of its body."""
        for b, (body, values) in enumerate(zip(self._bodies, nodal, strict=True)):
            own = self._values.array[self._layout.local_slice(b)]
            own[:: body.block_size] = values[: body.owned_nodes]

    def _column(self, body: BodyMechanics) -> FloatArray:
        """Return the pressure of the column at the local nodes of a body [Pa]; collective."""
        head = body.loads.potential()
        if body.name not in self._regions:
            return np.zeros_like(head)
        return column_pressure(self._regions[body.name], ~body.coherent, head)

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for side in self._sides:
            for entry in side.entries:
                entry.destroy()
        if self._means is not None:
            self._means.destroy()
        self._values.destroy()


def _growth(body: BodyMechanics) -> FloatArray:
    """Return the change in the trial step of what decides on the pull of a wall, (owned nodes,).

    That is the bearing share, and the last melt of a mush through which it flows.
    """
    own, melt = slice(body.owned_nodes), body.formulation.wall_melt
    nodes, before = body.material.conditions.nodes, body.material.start_nodes
    bears = np.abs(nodes.share - before.share)[own]
    return bears if melt is None else np.maximum(bears, melt.lost())


def _pressures_of_pull(body: BodyMechanics) -> FloatArray:
    """Return the largest pulls of a wall at the owned nodes [Pa], infinite where nothing bears."""
    share = body.material.conditions.nodes.share[: body.owned_nodes]
    melt, found = body.formulation.wall_melt, np.full(len(share), np.inf)
    if melt is not None:
        return np.where(share > 0.0, melt.pulls(), found)
    liquid = body.material.law.material.wall_suction * (1.0 - share)
    return np.asarray(np.divide(liquid, share, out=found, where=share > 0.0))
