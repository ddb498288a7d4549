"""The bodies that freeze, as their pools of liquid see them."""

from __future__ import annotations

from dataclasses import dataclass

from castx.case.bodies import DARCY
from castx.case.case import Case
from castx.foundry.alloy import missing
from castx.foundry.pools.feeding_surfaces import FeedingSurfaces, feeding_surfaces
from castx.materials.lookup import find_material

USUAL_LIMIT = 0.7
"""Solid fraction below which liquid flows in mass, where neither the user nor a coherency says; a
representative value."""

ALL_FREE = FeedingSurfaces()


@dataclass(frozen=True)
class PooledMetal:
    """A body that freezes, as its pools see it.

    Attributes:
        limit: solid fraction below which a node belongs to a pool.
        shrinkage: s = (ρ_s - ρ_l)/ρ_s; None: the material does not say.
        surfaces: that feed.
        flows: whether the mechanics lets its melt flow through the mush.
    """

    limit: float
    shrinkage: float | None = None
    surfaces: FeedingSurfaces = ALL_FREE
    flows: bool = False


def pooled_metals(case: Case) -> dict[str, PooledMetal]:
    """Return the bodies of a case that freeze, as their pools see them, by name."""
    found = {}
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        if body.starts_solid(material.description):
            continue
        limit = case.foundry.pool_limit
        if limit is None:
            limit = USUAL_LIMIT if material.liquid is None else material.liquid.coherency
        key = "solidification_shrinkage"
        known = not missing(material.description, (key,))
        shrinkage = material.description.solidification_shrinkage if known else None
        flows = body.feeding == DARCY and case.coupling.scheme != "thermal"
        surfaces = feeding_surfaces(case, body)
        found[body.name] = PooledMetal(limit, shrinkage, surfaces, flows)
    return found
