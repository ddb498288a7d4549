"""Grooves, threads and roundings that no casting needs: taken out, or refused where they crowd."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import gmsh

from castx.meshes.cad.curvature import FILLING
from castx.meshes.cad.description import MILLIMETRES, CadPart
from castx.meshes.cad.healing import SmallPart, details
from castx.meshes.cad.reading import Solid

NARROW = 8.0
"""Largest size of cells over the width of a narrow face, at least."""
SLENDER = 2.0
"""Size of cells that a narrow face takes, over its width."""
BEYOND = 1.1
"""Width of the narrowest faces that is proposed, over that of the widest in the crowd."""


def without_narrow_faces(
    solids: Sequence[Solid], narrowest: float
) -> tuple[list[Solid], list[str]]:
    """Take narrow faces out of solids of the current gmsh model; those round them grow together.

    What cannot be closed, such as the rim of a thin plate, stays.

    Args:
        solids: as read.
        narrowest: width of the narrowest faces that stay [m].

    Returns:
        The solids, and what was done, in words.
    """
    kept, remarks = [], []
    for solid in solids:
        narrow = _narrow_faces(solid.tag, narrowest)
        if not narrow:
            kept.append(solid)
            continue
        first, before = narrow[0].text, gmsh.model.occ.getMass(3, solid.tag)
        new = replace(solid, tag=_defeatured(solid.tag, [face.tag for face in narrow]))
        kept.append(new)
        left = len(_narrow_faces(new.tag, narrowest))
        share = gmsh.model.occ.getMass(3, new.tag) / before - 1.0
        stay = f"; {left} others are narrower and stay, nothing closes there" if left else ""
        remarks.append(
            f"{solid.name}: {len(narrow) - left} faces narrower than geometry.narrowest, "
            f"{narrowest:g} m, are left out with the grooves, threads or roundings that they "
            f"bound, which changes its volume by {100.0 * share:+.2g} %: {first}{stay}"
        )
    return kept, remarks


def _narrow_faces(volume: int, narrowest: float) -> list[SmallPart]:
    if narrowest == 0.0:
        return []
    return [part for part in details([volume]) if part.what == "face" and part.width < narrowest]


def _defeatured(volume: int, faces: Sequence[int]) -> int:
    """Return the tag of a volume without faces."""
    try:
        made = gmsh.model.occ.defeature([volume], faces, removeVolume=True)
    except Exception:  # gmsh raises nothing more special
        return volume
    gmsh.model.occ.synchronize()
    return int(made[0][1]) if len(made) == 1 else volume


def refuse_narrow_faces(part: CadPart, volumes: Sequence[int]) -> None:
    """Refuse narrow faces that alone need too many cells, with a cure, before they are meshed.

    Cells twice as long as a face is wide are the flattest ones on which anything can be solved.

    Args:
        part: what is meshed.
        volumes: of the current gmsh model.

    Raises:
        ValueError: with their number, the narrowest one, and the width that takes them out.
    """
    crowd = [
        detail
        for detail in details(volumes)
        if detail.what == "face" and NARROW * detail.width <= part.size
    ]
    cells = sum(_cells_on(detail, part) for detail in crowd)
    if cells > part.most_cells:
        raise ValueError(
            f"about {cells:.1e} cells, and geometry.most_cells allows {part.most_cells:.1e}, on "
            f"{len(crowd)} narrow faces of grooves, threads or roundings: {crowd[0].text}; leave "
            f"them out, geometry.narrowest = {BEYOND * crowd[-1].width:.2g}, suppress them in "
            "CAD, or allow more cells"
        )


def _cells_on(detail: SmallPart, part: CadPart) -> float:
    area = gmsh.model.occ.getMass(2, detail.tag) / MILLIMETRES**2
    finest = (SLENDER * detail.width) ** -2
    return float(area * (finest - part.size**-2) / (2.0 * part.growth) / FILLING)
