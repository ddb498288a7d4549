"""Continuation of pools in a step: the region of each pool, new pools, merged pools."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

SAME = 1e-6
"""Relative difference of volumes that counts as none: which of equal halves is the larger one would
else be decided by rounding, and so by the ranks."""


@dataclass(frozen=True)
class Heritage:
    """The pools after a step.

    Attributes:
        numbers: of the pool that each region is.
        parents: of the pools that are new, the one they come from; None: there was no liquid.
        merged: the pools that have become part of another one, by its number.
        gone: pools of which no liquid is left.
    """

    numbers: list[int]
    parents: dict[int, int | None] = field(default_factory=dict)
    merged: dict[int, list[int]] = field(default_factory=dict)
    gone: list[int] = field(default_factory=list)

    @classmethod
    def of(
        cls,
        shares: Mapping[tuple[int, int], float],
        regions: int,
        living: Collection[int],
        following: int,
    ) -> Heritage:
        """Return the continuation of the pools of the last step in the present regions.

        A pool goes on in the region that has most of its liquid, other regions with a part of it
        are new pools; of several that go on in one region the lowest number stays.

        Args:
            shares: volume of liquid that was in a pool and is in a region, by both.
            regions: how many there are.
            living: numbers of the pools before.
            following: the lowest number that was never given.
        """
        claims: list[list[int]] = [[] for _ in range(regions)]
        gone = []
        for pool in sorted(living):
            own = {region: volume for (of, region), volume in shares.items() if of == pool}
            if own:
                claims[largest(own)].append(pool)
            else:
                gone.append(pool)
        found = cls([], gone=gone)
        for region, claim in enumerate(claims):
            if not claim:
                origin = {of: volume for (of, to), volume in shares.items() if to == region}
                found.parents[following] = largest(origin) if origin else None
                claim = [following]
                following += 1
            found.numbers.append(claim[0])
            if claim[1:]:
                found.merged[claim[0]] = claim[1:]
        return found


def largest(volumes: Mapping[int, float]) -> int:
    """Return the key of the largest volume, the lowest one of equal volumes."""
    least = (1.0 - SAME) * max(volumes.values())
    return min(key for key, volume in volumes.items() if volume >= least)
