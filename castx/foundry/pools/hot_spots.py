"""Hot spots: the isolated pools of liquid of all bodies that freeze, ranked, and their table."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.pools.feeding_surfaces import FeedingNodes
from castx.foundry.pools.pool import HotSpot, hot_spot, ranked
from castx.foundry.pools.pooled_metal import PooledMetal
from castx.foundry.pools.tracking import BodyPools
from castx.results.states.quantities import parts
from castx.results.states.snapshot import Snapshot
from castx.stateful import Arrays, Saved, joined, part_of

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

POOL = "pool"
"""Name of the field of pools."""


class HotSpots:
    """The pools of all bodies that freeze, and those that are isolated as hot spots.

    Args:
        mesh: the bodies.
        metals: those that freeze, by name.
    """

    def __init__(self, mesh: CastingMesh, metals: Mapping[str, PooledMetal]) -> None:
        self._model, self._metals = mesh.model, metals
        self._bodies = {
            name: BodyPools(mesh.bodies[name], mesh.model, metal.limit)
            for name, metal in metals.items()
        }
        self._feeding = {
            name: FeedingNodes(mesh.bodies[name], mesh.model, metal.surfaces)
            for name, metal in metals.items()
        }

    def update(self, snapshot: Snapshot) -> None:
        """Follow the pools to the state after an accepted step; collective."""
        for name, pools in self._bodies.items():
            if name not in snapshot.mesh.bodies:
                continue
            if name in snapshot.process.renewed:
                pools.begin()
            feeds = self._feeding[name].any(list(snapshot.pairs))
            pools.update(snapshot.time, snapshot.nodal(name, "solid_fraction"), feeds)

    def numbers(self, body: str) -> FloatArray | None:
        """Return the pool of each local node of a body, not a number outside; None: it has none."""
        if body not in self._bodies:
            return None
        numbers = self._bodies[body].numbers
        return np.where(numbers > 0, numbers, np.nan)

    @property
    def ranked(self) -> list[HotSpot]:
        """The isolated pools of all bodies, the worst first; equal on all ranks."""
        return ranked(
            [
                hot_spot(name, pool, self._metals[name].shrinkage)
                for name, pools in self._bodies.items()
                for pool in pools.known
                if pool.isolation is not None
            ]
        )

    def described(self) -> list[dict[str, Any]]:
        """Return the hot spots for run.json, the worst first."""
        return [describe(spot) for spot in self.ranked]

    def table(self) -> str:
        """Return the hot spots as text of a CSV file, the worst first."""
        file = io.StringIO()
        writer = csv.writer(file, lineterminator="\n")
        axes = parts("displacement", self._model)
        writer.writerow(
            ["rank", "body", "pool", "parent", "children", "merged", "isolated", "ended",
             *(f"last.{axis}" for axis in axes), *(f"centre.{axis}" for axis in axes),
             "volume", "deficit"]
        )  # fmt: skip
        for rank, spot in enumerate(self.described(), 1):
            numbers = (" ".join(map(str, spot[name])) for name in ("children", "merged"))
            times = spot["isolated"], spot["ended"]
            places = *spot["place"], *spot["centre"]
            row = [rank, spot["body"], spot["pool"], spot["parent"], *numbers, *times, *places,
                   spot["volume"], spot["deficit"]]  # fmt: skip
            writer.writerow(["" if value is None else value for value in row])
        return file.getvalue()

    def saved(self) -> dict[str, Saved]:
        """Return the state of all bodies; collective."""
        return joined({name: pools.saved() for name, pools in self._bodies.items()})

    def notes(self) -> dict[str, Any]:
        """Return the records of all bodies, as JSON knows them."""
        return {name: pools.notes() for name, pools in self._bodies.items()}

    def restore(self, arrays: Arrays, notes: Mapping[str, Any]) -> None:
        """Go on with the pools of an earlier part; a body that was not followed begins now."""
        for name, pools in self._bodies.items():
            if (part := part_of(arrays, name)) and name in notes:
                pools.restore(part, notes[name])


def describe(spot: HotSpot) -> dict[str, Any]:
    """Return a hot spot as JSON knows it."""
    pool, isolation = spot.pool, spot.pool.isolation
    assert isolation is not None
    return {
        "body": spot.body,
        "pool": pool.number,
        "parent": pool.parent,
        "children": list(pool.children),
        "merged": list(pool.merged),
        "isolated": isolation.time,
        "ended": pool.ended,
        "place": list(pool.place),
        "centre": list(isolation.centre),
        "volume": isolation.volume,
        "deficit": spot.deficit,
    }
