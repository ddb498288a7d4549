"""The surfaces of a casting through which metal is fed: no part of the shape that is asked for.

In the mechanics what shrinks is made up for by new metal that enters through them, so that they
stand where the feeder was, while in truth the melt there sinks (`castx.foundry.pools.pipe`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import IntArray
from castx.case.bodies import DARCY
from castx.case.case import Case
from castx.foundry.pools.feeding_surfaces import FeedingSurfaces, feeding_surfaces, open_facets
from castx.materials.lookup import find_material

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


def fed_facets(body: BodyMesh, model: str, surfaces: FeedingSurfaces) -> IntArray:
    """Return the owned facets of a body through which metal is fed beside all its neighbours.

    Args:
        body: its mesh.
        model: geometric model.
        surfaces: that feed.
    """
    if surfaces.named is not None:
        named = [body.facet_tags.find(body.surface_tag(name)) for name in surfaces.named]
        return np.concatenate([np.zeros(0, dtype=np.int32), *named])
    return open_facets(body, model, surfaces.closed(tuple(surfaces.facing)))


def fed_surfaces(case: Case) -> dict[str, FeedingSurfaces]:
    """Return the surfaces through which the mechanics feeds the castings of a case, by body.

    A casting that faces no other body has none: all of its surface is asked for.
    """
    found = {}
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        if body.law == "rigid" or not body.is_poured(material):
            continue
        free = feeding_surfaces(case, body, named=False)
        if free.facing:
            flows = body.feeding == DARCY
            found[body.name] = feeding_surfaces(case, body) if flows else free
    return found
