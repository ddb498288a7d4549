"""Reach of feeders: the paths from them inside the casting to places without pores."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

import basix
import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.case.case import Case
from castx.foundry.pools.feeding_surfaces import FeedingNodes
from castx.foundry.pools.geodesic import shortest_paths
from castx.foundry.pools.pooled_metal import pooled_metals
from castx.stateful import Arrays, Saved

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

Pores = Callable[[str], FloatArray]
"""Returns the pore fraction of the nodes of a body that freezes, (nodes,); collective."""

FEEDING_PATH = "feeding_path"
"""Name of the field of distances from the nearest feeder."""


def paths_to(body: BodyMesh, feeders: BoolArray) -> FloatArray:
    """Return the shortest paths from the local nodes to feeders, (nodes,) [m]; collective.

    The first rank finds them on the whole mesh, so that they do not depend on the ranks. Not a
    number where there is no path.

    Args:
        body: its mesh.
        feeders: whether nodes lie on one, ghosts included, (nodes,).
    """
    comm: MPI.Intracomm = body.mesh.comm
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    original = body.original_nodes
    own = original, body.points, original[body.nodes.dofmap.list[:owned]], feeders
    parts = comm.gather(own)
    found = None
    if parts is not None:
        numbers, points, cells, ends = (
            np.concatenate(column) for column in zip(*parts, strict=True)
        )
        known, first = np.unique(numbers, return_index=True)
        chosen = np.isin(known, numbers[ends])
        lengths = shortest_paths(points[first], np.searchsorted(known, cells), chosen)
        found = known, lengths
    known, lengths = comm.bcast(found)
    paths = lengths[np.searchsorted(known, original)]
    return np.where(np.isfinite(paths), paths, np.nan)


def feeding_distance(
    body: BodyMesh, paths: FloatArray, pores: FloatArray, limit: float
) -> float | None:
    """Return the longest path to a place with fewer pores than a limit [m]; collective.

    Along edges both are linear. None: there is no such place.

    Args:
        body: its mesh.
        paths: of the local nodes to a feeder, (nodes,) [m].
        pores: pore fraction of the local nodes, (nodes,).
        limit: of pore fraction.
    """
    ends = np.array(basix.topology(basix.CellType[body.kind.name])[1])
    edges = body.nodes.dofmap.list[:, ends].reshape(-1, 2)
    sound = pores < limit
    longest = float(paths[sound & np.isfinite(paths)].max(initial=-np.inf))
    for one, other in (edges.T, edges.T[::-1]):
        crossed = sound[one] & (pores[other] >= limit) & np.isfinite(paths[one] + paths[other])
        a, b = one[crossed], other[crossed]
        share = (limit - pores[a]) / (pores[b] - pores[a])
        longest = max(
            longest, float((paths[a] + share * (paths[b] - paths[a])).max(initial=-np.inf))
        )
    longest = body.mesh.comm.allreduce(longest, MPI.MAX)
    return longest if np.isfinite(longest) else None


class FeedingReach:
    """Paths from the feeders that bodies have when they are poured, and how far they feed.

    Args:
        bodies: that freeze, with the nodes on their feeders, (nodes,).
        pores: returns the pore fraction of the nodes of a body.
        limit: of pore fraction, below which a place counts as fed.
    """

    def __init__(
        self, bodies: Sequence[tuple[BodyMesh, BoolArray]], pores: Pores, limit: float
    ) -> None:
        self._bodies = {body.name: body for body, _ in bodies}
        self._paths = {body.name: paths_to(body, feeders) for body, feeders in bodies}
        self._pores, self._limit = pores, limit

    def update(self, state: Any) -> None:
        """Take over nothing: what freezing leaves is followed elsewhere."""

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return the shortest paths to a feeder, (nodes,) [m]; None: unknown."""
        return self._paths.get(body) if name == FEEDING_PATH else None

    def totals(self) -> dict[str, float]:
        """Return nothing: the distance is known at the end."""
        return {}

    def described(self) -> dict[str, float | None]:
        """Return the feeding distances so far by body for run.json [m]; collective."""
        return {
            name: feeding_distance(body, self._paths[name], self._pores(name), self._limit)
            for name, body in self._bodies.items()
        }

    def saved(self) -> dict[str, Saved]:
        """Return nothing: mesh and case say all."""
        return {}

    def restore(self, arrays: Arrays) -> None:
        """Have nothing to restore."""


def feeding_reach_of(
    case: Case, mesh: CastingMesh, present: Iterable[str], pores: Pores
) -> FeedingReach:
    """Return the feeding reach of the bodies of a case, empty without that field; collective.

    Args:
        case: what is run.
        mesh: the bodies.
        present: names of the interfaces, whose surfaces are not free.
        pores: returns the pore fraction of the nodes of a body.
    """
    wanted = pooled_metals(case) if FEEDING_PATH in case.output.fields else {}
    bodies = [
        (mesh.bodies[name], FeedingNodes(mesh.bodies[name], mesh.model, metal.surfaces))
        for name, metal in wanted.items()
    ]
    here = list(present)
    marked = [(body, nodes.any(here)) for body, nodes in bodies]
    return FeedingReach(marked, pores, case.foundry.porosity_limit)
