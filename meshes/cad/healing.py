"""Edges and faces of CAD solids that are too small to mean anything: mended, or refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.description import MILLIMETRES
from castx.meshes.cad.reading import Solid, centre_of, place_text

WORST_CELL = 2e-3
"""Least quality of a cell: its inscribed over its circumscribed radius, 1 in a regular one."""
POINT = 1e-9
"""Length of an edge that is the pole of a ball or the tip of a cone, no edge at all [mm]."""


@dataclass(frozen=True)
class SmallPart:
    """A small edge or face.

    Args:
        what: "edge" or "face".
        tag: in the model.
        width: length of an edge, area of a face over half of its circumference [m].
    """

    what: str
    tag: int
    width: float

    @property
    def text(self) -> str:
        """The detail in words."""
        size = "long" if self.what == "edge" else "wide"
        place = place_text(centre_of(1 if self.what == "edge" else 2, self.tag))
        return f"the {self.what} at {place} is {self.width:.2g} m {size}"


def details(volumes: Sequence[int]) -> list[SmallPart]:
    """Return edges and faces of volumes, the smallest first."""
    found = []
    entities = gmsh.model.getBoundary([(3, tag) for tag in volumes], combined=False, oriented=False)
    for face in sorted({tag for _, tag in entities}):
        edges = gmsh.model.getBoundary([(2, face)], combined=False, oriented=False)
        lengths = {tag: gmsh.model.occ.getMass(1, tag) for _, tag in edges}
        found += [
            SmallPart("edge", tag, x / MILLIMETRES) for tag, x in lengths.items() if x > POINT
        ]
        around = sum(lengths[tag] for _, tag in edges)
        if around > POINT:
            width = 2.0 * gmsh.model.occ.getMass(2, face) / around
            found.append(SmallPart("face", face, width / MILLIMETRES))
    unique = {(detail.what, detail.tag): detail for detail in found}
    return sorted(unique.values(), key=lambda detail: detail.width)


def mend(solids: Sequence[Solid], tolerance: float) -> tuple[list[Solid], list[str]]:
    """Remove edges and faces below a tolerance from solids of the current gmsh model.

    Args:
        solids: as read.
        tolerance: of what is removed [m].

    Returns:
        The solids, and what was done, in words.
    """
    mended, remarks = [], []
    for solid in solids:
        small = [detail for detail in details([solid.tag]) if detail.width < tolerance]
        if not small:
            mended.append(solid)
            continue
        first = small[0].text
        tag = _healed(solid, tolerance)
        mended.append(replace(solid, tag=tag))
        remarks.append(
            f"{solid.name}: {len(small)} edges and faces below geometry.tolerance, "
            f"{tolerance:g} m, mended: {first}"
        )
    return mended, remarks


def _healed(solid: Solid, tolerance: float) -> int:
    """Return the tag of a solid without its small edges and faces."""
    others = {tag for _, tag in gmsh.model.getEntities(3)} - {solid.tag}
    try:
        gmsh.model.occ.healShapes(
            [(3, solid.tag)], tolerance * MILLIMETRES, fixDegenerated=False, fixSmallEdges=True,
            fixSmallFaces=True, sewFaces=True, makeSolids=True,
        )  # fmt: skip
        gmsh.model.occ.synchronize()
    except Exception:  # gmsh raises nothing more special; `refuse_small` says what is left
        return solid.tag
    made = [tag for _, tag in gmsh.model.getEntities(3) if tag not in others]
    lone = [
        entity
        for dim in (2, 1, 0)
        for entity in gmsh.model.getEntities(dim)
        if not len(gmsh.model.getAdjacencies(*entity)[0])
    ]
    gmsh.model.occ.remove(lone, recursive=True)
    gmsh.model.occ.synchronize()
    return made[0] if len(made) == 1 else solid.tag


def refuse_small(volumes: Sequence[int], tolerance: float) -> None:
    """Refuse edges and faces below a tolerance that are left.

    Args:
        volumes: of the current gmsh model.
        tolerance: [m].

    Raises:
        ValueError: with the smallest one, its place and size.
    """
    small = [detail for detail in details(volumes) if detail.width < tolerance]
    if small:
        more = f" (and {len(small) - 1} others)" if len(small) > 1 else ""
        raise ValueError(
            f"{small[0].text}{more}, less than geometry.tolerance, {tolerance:g} m, and cannot be "
            "mended; repair it in CAD, or lower the tolerance"
        )


def refuse_flat_cells(volumes: Sequence[int], cells: FloatArray, qualities: FloatArray) -> None:
    """Refuse a mesh with cells so flat that nothing can be solved on them.

    Args:
        volumes: of the current gmsh model.
        cells: centres of the cells, shape (cells, 3) [m].
        qualities: of the cells.

    Raises:
        ValueError: with the place of the worst cell and what is small round it.
    """
    worst = int(np.argmin(qualities))
    if qualities[worst] >= WORST_CELL:
        return
    flat = int(np.count_nonzero(qualities < WORST_CELL))
    narrow = details(volumes)[0]
    raise ValueError(
        f"{flat} cells are flat, the worst at {place_text(cells[worst])} with a quality of "
        f"{qualities[worst]:.1g} (at least {WORST_CELL:g} is needed); the smallest detail of the "
        f"solids is near or elsewhere: {narrow.text}. Raise geometry.tolerance above it if it is "
        "a fault of the drawing, else choose smaller sizes there"
    )
