"""A mould cut out of a block, with chills, cores, cooling channels, and planes of symmetry."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.description import (
    MILLIMETRES,
    Box,
    CadPart,
    Channel,
    Chill,
    Mould,
    SymmetryPlane,
    Vector,
)
from castx.meshes.cad.faces import Face
from castx.meshes.cad.reading import Solid, centre_of, place_text
from castx.meshes.model import symmetry_plane

CHANNEL, CORE, DRAWN, CHILL, BLOCK = 4, 3, 2, 1, 0
"""Ranks of solids: where several are, the highest one stays."""
ON_SURFACE = 1e-6
"""Distance that counts as none, in extents of the part."""


def with_mould(part: CadPart, solids: Sequence[Solid]) -> list[Solid]:
    """Add mould, chills and channels to the solids of the current gmsh model, cut by symmetry.

    Args:
        part: what is meshed.
        solids: as read.

    Returns:
        All solids with their ranks.

    Raises:
        ValueError: a name fits no body, a channel meets a body, or a plane leaves nothing of one.
    """
    mould, names = part.mould, {solid.name for solid in solids}
    made = [replace(solid, rank=DRAWN) for solid in solids]
    if mould is not None:
        for core in mould.cores:
            if core not in names:
                known = ", ".join(sorted(names))
                raise ValueError(f"mould.cores: no body {core!r}; there are: {known}")
        made = [replace(s, rank=CORE) if s.name in mould.cores else s for s in made]
        made += [Solid(_chill(chill), chill.name, "", CHILL) for chill in mould.chills]
        gmsh.model.occ.synchronize()
        made += _block(mould, made)
        plugs = () if mould.plug is None else (mould.plug,)
        _refuse_names_of_solids(names, (*(solid.name for solid in made[len(solids) :]), *plugs))
        for channel in mould.channels:
            made += [Solid(tag, channel.name, "", CHANNEL) for tag in _channel(channel)]
        gmsh.model.occ.synchronize()
    for plane in part.symmetry:
        made = _halved(made, plane)
    return made


def _refuse_names_of_solids(names: Collection[str], made: Sequence[str]) -> None:
    """Refuse bodies that are made and called like a solid of the files."""
    for name in made:
        if name in names:
            raise ValueError(
                f"a solid is called {name!r} like the body that is made by geometry.mould; "
                "give one of them another name: geometry.names, or name under geometry.mould"
            )


def _corners(box: Box) -> tuple[FloatArray, FloatArray]:
    lowest, highest = (MILLIMETRES * np.array(corner) for corner in box)
    return lowest, highest


def _box(box: Box) -> int:
    lowest, highest = _corners(box)
    return int(gmsh.model.occ.addBox(*lowest, *(highest - lowest)))


def _cylinder(first: Vector, last: Vector, diameter: float) -> int:
    start, end = MILLIMETRES * np.array(first), MILLIMETRES * np.array(last)
    return int(gmsh.model.occ.addCylinder(*start, *(end - start), 0.5 * MILLIMETRES * diameter))


def _chill(chill: Chill) -> int:
    if chill.box is not None:
        return _box(chill.box)
    assert chill.line is not None
    return _cylinder(*chill.line, chill.diameter)


def _channel(channel: Channel) -> Iterator[int]:
    for first, last in pairwise(channel.line):
        yield _cylinder(first, last, channel.diameter)
    radius = 0.5 * MILLIMETRES * channel.diameter
    for bend in channel.line[1:-1]:
        yield int(gmsh.model.occ.addSphere(*(MILLIMETRES * np.array(bend)), radius))


def extents(tags: Sequence[int]) -> Box:
    """Return the box round volumes of the current gmsh model [m]."""
    boxes = np.array([gmsh.model.occ.getBoundingBox(3, tag) for tag in tags])
    lowest, highest = boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)
    low, high = (np.round(x, 6) / MILLIMETRES for x in (lowest, highest))
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _block(mould: Mould, solids: Sequence[Solid]) -> list[Solid]:
    """Return the solids of the block, one or two halves, before anything is cut out of it."""
    if mould.box is not None:
        lowest, highest = (np.array(corner) for corner in mould.box)
    else:
        lowest, highest = (np.array(corner) for corner in extents([s.tag for s in solids]))
        lowest, highest = lowest - mould.room, highest + mould.room
    if mould.split is None:
        return [Solid(_box((tuple(lowest), tuple(highest))), mould.name, "", BLOCK)]
    axis, place = mould.split
    if not lowest[axis] < place < highest[axis]:
        raise ValueError(
            f"mould.split: the plane {'xyz'[axis]} = {place:g} m does not meet the block, from "
            f"{place_text(lowest)} to {place_text(highest)}"
        )
    below, above = highest.copy(), lowest.copy()
    below[axis] = above[axis] = place
    low, high = mould.bodies
    return [
        Solid(_box((tuple(lowest), tuple(below))), low, "", BLOCK),
        Solid(_box((tuple(above), tuple(highest))), high, "", BLOCK),
    ]


def whole_halves(
    volumes: Mapping[int, str], mould: Mould | None
) -> tuple[dict[int, str], list[str]]:
    """Return the body of each volume with loose pieces of a half at the other one.

    A planar split cuts the plug inside a cup off from its half. It hangs at the other half, which
    it touches across the plane, and comes out with that. The plug of a cup whose rim is bare hangs
    at neither: it is the body that the mould names, or its parts stay together, with the half in
    which more of it lies.

    Args:
        volumes: of the joined solids in the current gmsh model, by tag.
        mould: that was made; None: none was.

    Returns:
        The volumes, and a remark for each body of which pieces were given away.
    """
    found, remarks = dict(volumes), list[str]()
    if mould is None or (mould.split is None and mould.plug is None):
        return found, remarks
    faces = {tag: _faces(tag) for tag, name in volumes.items() if name in mould.bodies}
    *bare, block = _pieces(faces)
    for half, other in (mould.bodies, mould.bodies[::-1]) if mould.split else ():
        loose = _pieces({tag: own for tag, own in faces.items() if volumes[tag] == half})[:-1]
        given = [piece for piece in loose if piece[0] in block]
        found |= {tag: other for piece in given for tag in piece}
        if given:
            remarks.append(
                f"split cuts {_counted(given)} off from {half!r}, round {_places(given)}; "
                f"{other!r} has them, the half that they hang at"
            )
    if mould.plug is not None:
        found |= {tag: mould.plug for piece in bare for tag in piece}
        return found, [*remarks, *_plugs(bare, mould.plug)]
    for piece in bare:
        parts = [[tag for tag in piece if volumes[tag] == half] for half in mould.bodies]
        if all(parts):
            half = mould.bodies[int(_volume(parts[1]) > _volume(parts[0]))]
            found |= dict.fromkeys(piece, half)
            remarks.append(
                f"split cuts {_counted([piece])} in two that touches neither half, round "
                f"{_places(parts)}; {half!r} has it, the half in which more of it lies"
            )
    return found, remarks


def _plugs(pieces: Sequence[Sequence[int]], name: str) -> Iterator[str]:
    if pieces:
        yield (
            f"{_counted(pieces)} of the mould, round {_places(pieces)}, "
            f"{'hangs' if len(pieces) == 1 else 'hang'} at no other part of it: the body {name!r}"
        )


def _counted(pieces: Sequence[Sequence[int]]) -> str:
    return "1 piece" if len(pieces) == 1 else f"{len(pieces)} pieces"


def _places(pieces: Sequence[Sequence[int]]) -> str:
    return ", ".join(place_text(_centre(piece)) for piece in pieces)


def _centre(piece: Sequence[int]) -> FloatArray:
    weights = [_volume([tag]) for tag in piece]
    return np.asarray(np.average([centre_of(3, tag) for tag in piece], axis=0, weights=weights))


def _pieces(faces_of: Mapping[int, set[int]]) -> list[list[int]]:
    """Return volumes that hang together by faces, the smallest piece first."""
    left, pieces = dict(faces_of), list[list[int]]()
    while left:
        first = next(iter(left))
        piece, faces = [first], left.pop(first)
        while joined := [tag for tag, own in left.items() if own & faces]:
            piece += joined
            faces = faces.union(*(left.pop(tag) for tag in joined))
        pieces.append(piece)
    return sorted(pieces, key=_volume)


def _volume(tags: Sequence[int]) -> float:
    return float(sum(gmsh.model.occ.getMass(3, tag) for tag in tags))


def _faces(volume: int) -> set[int]:
    return {tag for _, tag in gmsh.model.getBoundary([(3, volume)], oriented=False)}


def _halved(solids: Sequence[Solid], plane: SymmetryPlane) -> list[Solid]:
    """Return the parts of solids on one side of a plane of symmetry."""
    lowest, highest = (np.array(corner) for corner in extents([s.tag for s in solids]))
    reach = np.ptp([lowest, highest], axis=0).max() + 1.0 / MILLIMETRES
    low, high = lowest - reach, highest + reach
    (low if plane.above else high)[plane.axis] = plane.place
    halves = []
    for solid in solids:
        half = _box((tuple(low), tuple(high)))
        pieces, _ = gmsh.model.occ.intersect([(3, solid.tag)], [(3, half)])
        gmsh.model.occ.synchronize()
        tags = [tag for dim, tag in pieces if dim == 3]
        if not tags and solid.rank != CHANNEL:
            side = ">" if plane.above else "<"
            raise ValueError(
                f"symmetry: nothing of {solid.name!r} lies in {'xyz'[plane.axis]} {side} "
                f"{plane.place:g} m"
            )
        halves += [replace(solid, tag=tag) for tag in tags]
    return halves


def named_by_making(part: CadPart, faces: Sequence[Face]) -> dict[str, list[Face]]:
    """Return the free faces of planes of symmetry and of channels, by their names.

    Args:
        part: what is meshed.
        faces: of the joined solids.
    """
    points = np.concatenate([face.points for face in faces])
    tolerance = ON_SURFACE * float(np.ptp(points, axis=0).max()) + part.tolerance
    named: dict[str, list[Face]] = {}
    for face in faces:
        if len(face.bodies) == 1:
            name = _name_by_making(part, face, tolerance)
            if name is not None:
                named.setdefault(name, []).append(face)
    return named


def _name_by_making(part: CadPart, face: Face, tolerance: float) -> str | None:
    for plane in part.symmetry:
        if (np.abs(face.points[:, plane.axis] - plane.place) <= tolerance).all():
            return symmetry_plane(plane.axis)
    if part.mould is None or face.bodies[0] not in part.mould.parts:
        return None
    for channel in part.mould.channels:
        radius = 0.5 * channel.diameter
        if (distances_to_line(face.points, channel.line) <= radius + tolerance).all():
            return channel.name
    return None


def distances_to_line(points: FloatArray, line: Sequence[Vector]) -> FloatArray:
    """Return the distances of points from a line of straight parts.

    Args:
        points: (points, 3) [m].
        line: its corners [m].
    """
    distances = np.full(len(points), np.inf)
    for first, last in pairwise(line):
        start, along = np.array(first), np.array(last) - np.array(first)
        parameter = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
        foot = start + parameter[:, None] * along
        distances = np.minimum(distances, np.linalg.norm(points - foot, axis=1))
    return distances
