"""Solids that touch, with their common faces shared."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import gmsh
import numpy as np

from castx.meshes.cad.description import MILLIMETRES
from castx.meshes.cad.reading import Solid, centre_of, place_text, solid_list


def join(solids: Sequence[Solid], tolerance: float, drills: Collection[int] = ()) -> dict[int, str]:
    """Divide solids along their common faces, and return the body of each volume of the model.

    Args:
        solids: of the current gmsh model.
        tolerance: gaps and overlaps up to it are closed [m].
        drills: tags of solids that are no bodies: the others have holes where they are.

    Raises:
        ValueError: solids of two bodies of one rank overlap, or one of them vanishes.
    """
    _refuse_hollow(solids, tolerance)
    if len(solids) == 1:
        return {solids[0].tag: solids[0].name}
    gmsh.option.setNumber("Geometry.ToleranceBoolean", tolerance * MILLIMETRES)
    try:
        _, pieces = gmsh.model.occ.fragment([(3, solid.tag) for solid in solids], [])
    except Exception as error:  # gmsh raises nothing more special
        raise ValueError(
            f"the solids cannot be joined: {error}; repair them in CAD, or change "
            f"geometry.tolerance, {tolerance:g} m"
        ) from None
    finally:
        gmsh.option.setNumber("Geometry.ToleranceBoolean", 0.0)
    gmsh.model.occ.synchronize()
    owners: dict[int, list[Solid]] = {}
    for solid, parts in zip(solids, pieces, strict=True):
        volumes = [tag for dim, tag in parts if dim == 3]
        if not volumes:
            raise ValueError(f"the solid {solid.name!r} is thinner than the tolerance everywhere")
        for tag in volumes:
            owners.setdefault(tag, []).append(solid)
    top = {tag: _highest(owner) for tag, owner in owners.items()}
    _refuse_overlaps(top, tolerance)
    removed = [tag for tag, owner in top.items() if owner[0].tag in drills]
    for tag in removed:
        _refuse_drilled(tag, owners[tag], drills)
    gmsh.model.occ.remove([(3, tag) for tag in removed], recursive=True)
    gmsh.model.occ.synchronize()
    return {tag: owner[0].name for tag, owner in top.items() if tag not in removed}


def _highest(owners: Sequence[Solid]) -> list[Solid]:
    rank = max(owner.rank for owner in owners)
    return [owner for owner in owners if owner.rank == rank]


def _refuse_drilled(tag: int, owners: Sequence[Solid], drills: Collection[int]) -> None:
    """Refuse a channel that meets a body beside the block."""
    met = sorted({o.name for o in owners if o.tag not in drills and o.rank > 0})
    if met:
        channel = next(owner.name for owner in owners if owner.tag in drills)
        raise ValueError(
            f"the channel {channel!r} meets the body {met[0]!r} round "
            f"{place_text(centre_of(3, tag))}; move it"
        )


def _refuse_hollow(solids: Sequence[Solid], tolerance: float) -> None:
    """Refuse solids without volume, and skins that a cut in CAD has left over."""
    for solid in solids:
        volume = gmsh.model.occ.getMass(3, solid.tag)
        if not volume > 0.0:
            raise ValueError(
                f"the solid {solid.name!r} round {_middle_text(solid.tag)} has no volume or is "
                "turned inside out; repair it in CAD"
            )
        faces = gmsh.model.getBoundary([(3, solid.tag)], oriented=False)
        thickness = 2.0 * volume / sum(gmsh.model.occ.getMass(*face) for face in faces)
        if thickness < tolerance * MILLIMETRES:
            raise ValueError(
                f"the solid {solid.name!r} round {_middle_text(solid.tag)} is "
                f"{thickness / MILLIMETRES:.1g} m thick in the mean, less than geometry.tolerance, "
                f"{tolerance:g} m: a rest of what was cut away, or faces that cross each other; "
                "remove or repair it in CAD"
            )


def _middle_text(tag: int) -> str:
    """Return the middle of the box round a solid: one without volume has no centre of mass."""
    box = np.reshape(gmsh.model.getBoundingBox(3, tag), (2, 3))
    return place_text(box.mean(axis=0) / MILLIMETRES)


def _refuse_overlaps(owners: dict[int, list[Solid]], tolerance: float) -> None:
    overlaps = {
        tag: sorted({solid.name for solid in owner})
        for tag, owner in owners.items()
        if len({solid.name for solid in owner}) > 1
    }
    if not overlaps:
        return
    volumes = {tag: gmsh.model.occ.getMass(3, tag) / MILLIMETRES**3 for tag in overlaps}
    worst = max(volumes, key=lambda tag: volumes[tag])
    names = " and ".join(repr(name) for name in overlaps[worst])
    raise ValueError(
        f"{names} overlap by {1e6 * volumes[worst]:.3g} cm³ round {place_text(centre_of(3, worst))}"
        f"{_others(len(overlaps) - 1)}; cut one of them in CAD, or raise geometry.tolerance, "
        f"{tolerance:g} m, above their mismatch"
    )


def _others(count: int) -> str:
    return f" (and at {count} other places)" if count else ""


def refuse_other_bodies(
    wanted: Sequence[str] | None, volumes: dict[int, str], solids: Sequence[Solid]
) -> None:
    """Refuse solids that are not the bodies of the case.

    Args:
        wanted: names of the bodies; None: any.
        volumes: body of each volume.
        solids: as read.

    Raises:
        ValueError: with all solids.
    """
    made = set(volumes.values())
    if wanted is None or made == set(wanted):
        return
    missing = [name for name in wanted if name not in made]
    if missing:
        text = f"no solid is the body {missing[0]!r}"
    else:
        extra = sorted(made - set(wanted))
        text = f"the case does not list the body {extra[0]!r} under [[bodies]]"
    raise ValueError(
        f"{text}; give it its name by geometry.names = {{ LABEL = BODY }}; the solids:\n"
        f"{solid_list([s for s in solids if s.tag in volumes] or solids)}"
    )
