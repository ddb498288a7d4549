"""The record of one pool of liquid, and the order of isolated ones as hot spots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Isolation:
    """State of a pool at the moment of its isolation from all feeding surfaces.

    Attributes:
        time: when it was cut off, within the step in which it was [s].
        centre: centroid of its liquid [m].
        volume: of its liquid at that time, Σ V_i g_i [m³].
    """

    time: float
    centre: tuple[float, ...]
    volume: float

    def with_others(self, others: Sequence[Isolation]) -> Isolation:
        """Merge the isolated liquid of pools: earliest time, common centre, total volume."""
        every = [self, *others]
        volume = sum(each.volume for each in every)
        centres = np.array([each.centre for each in every])
        centre = np.array([each.volume for each in every]) @ centres / volume
        return Isolation(min(each.time for each in every), tuple(centre.tolist()), volume)


@dataclass(frozen=True)
class Pool:
    """A pool of liquid.

    Attributes:
        number: from 1, for the whole run.
        began: when it was first found [s].
        parent: the pool of which it is a part that split off; None: there was none.
        children: the pools that have split off from it.
        merged: the pools that have become part of it.
        isolation: None as long as a surface feeds it.
        ended: when the last of it fell below the limit [s]; None: not yet.
        place: where that was; until then where its solid fraction is lowest [m].
    """

    number: int
    began: float
    parent: int | None = None
    children: tuple[int, ...] = ()
    merged: tuple[int, ...] = ()
    isolation: Isolation | None = None
    ended: float | None = None
    place: tuple[float, ...] = ()

    def with_merged(self, others: Sequence[Pool]) -> Pool:
        """Return the pool that this one has become together with others; its number stays."""
        isolations = [other.isolation for other in others]
        known = [isolation for isolation in isolations if isolation is not None]
        isolation = self.isolation
        if isolation is not None and len(known) == len(others):
            isolation = isolation.with_others(known)
        else:
            isolation = None
        numbers = sorted({*self.merged, *(other.number for other in others)})
        return replace(self, merged=tuple(numbers), isolation=isolation)

    def notes(self) -> dict[str, Any]:
        """Return the record as JSON knows it."""
        return asdict(self)

    @classmethod
    def of(cls, notes: Mapping[str, Any]) -> Pool:
        """Return the pool of a record."""
        known = dict(notes)
        for name in ("children", "merged", "place"):
            known[name] = tuple(known[name])
        if (isolation := known["isolation"]) is not None:
            known["isolation"] = Isolation(**{**isolation, "centre": tuple(isolation["centre"])})
        return cls(**known)


@dataclass(frozen=True)
class HotSpot:
    """An isolated pool with the volume that its metal lacks.

    Attributes:
        body: to which it belongs.
        pool: isolated.
        deficit: volume that its freezing lacks if nothing is fed any more, s V_l [m³]; None: the
            material does not say how much it shrinks.
    """

    body: str
    pool: Pool
    deficit: float | None


def hot_spot(body: str, pool: Pool, shrinkage: float | None) -> HotSpot:
    """Return an isolated pool with its deficit.

    Args:
        body: its name.
        pool: isolated.
        shrinkage: s = (ρ_s - ρ_l)/ρ_s of its metal; one that swells lacks nothing.
    """
    assert pool.isolation is not None
    lacking = None if shrinkage is None else max(shrinkage, 0.0) * pool.isolation.volume
    return HotSpot(body, pool, lacking)


def ranked(found: Sequence[HotSpot]) -> list[HotSpot]:
    """Return hot spots by deficit, then by when they end, the latest first, then by volume."""

    def place(spot: HotSpot) -> tuple[float, float, float, str, int]:
        pool = spot.pool
        assert pool.isolation is not None
        end = np.inf if pool.ended is None else pool.ended
        return -(spot.deficit or 0.0), -end, -pool.isolation.volume, spot.body, pool.number

    return sorted(found, key=place)
