"""Words of the case file that choose one face of a part, as few as do."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.case.cad.selectors import FaceSelector
from castx.domain.cad.description import selector_of
from castx.errors import CaseError
from castx.meshes.cad.faces import Face
from castx.meshes.cad.selection import select

TOLERANCE = 1e-6
"""Of lengths, as of a case that says nothing else [m]."""
GRIDS = (1e-4, 1e-6)
"""To which the corners of boxes are rounded outwards [m], the coarser one first."""
STRAIGHT = 1.0 - 1e-9
"""Length of the mean of unit normals from which a face counts as flat."""

Words = dict[str, Any]


def chosen(words: Any, faces: Sequence[Face], tolerance: float = TOLERANCE) -> list[int]:
    """Return the numbers of the faces that a selector of a case file finds.

    Args:
        words: keys and values of the selector.
        faces: of the part.
        tolerance: of lengths [m].

    Raises:
        CaseError: it is none, or finds no face.
    """
    selector = selector_of("it", FaceSelector.read(words), tolerance)
    number = {face.tag: index for index, face in enumerate(faces)}
    try:
        return [number[face.tag] for face in select(selector, faces)]
    except ValueError as error:
        raise CaseError(str(error)) from None


def proposed(number: int, faces: Sequence[Face]) -> Words:
    """Return a selector that finds one face alone, or the fewest that any finds.

    Args:
        number: of the face.
        faces: of the part.
    """
    best: tuple[int, Words] | None = None
    for words in proposals(faces[number], faces):
        try:
            found = chosen(words, faces)
        except CaseError:
            continue
        if number not in found:
            continue
        if len(found) == 1:
            return words
        if best is None or len(found) < best[0]:
            best = len(found), words
    if best is None:
        raise CaseError(f"no selector finds this face: {faces[number].text}")
    return best[1]


def proposals(face: Face, faces: Sequence[Face]) -> Iterator[Words]:
    """Yield selectors of a face, from the words that outlive most changes of the part on."""
    base: Words = {}
    if len({body for other in faces for body in other.bodies}) > 1:
        base["body"] = face.bodies[0]
    if len(face.bodies) > 1:
        base["touches"] = face.bodies[1]
    shape = shape_of(face)
    yield base | shape
    yield base | shape | {"largest": 1}
    for grid in GRIDS:
        inside = {"within": box_of(face.points, grid)}
        yield base | shape | inside
        yield base | shape | inside | {"largest": 1}
        yield base | inside


def shape_of(face: Face) -> Words:
    """Return the outward direction of a flat face, or the radius of a round one."""
    normal = face.normals.mean(axis=0)
    length = float(np.linalg.norm(normal))
    if length <= STRAIGHT:
        return {} if face.radius is None else {"radius": float(f"{face.radius:.6g}")}
    along = normal / length
    axis = int(np.abs(along).argmax())
    if abs(along[axis]) > STRAIGHT:
        return {"normal": f"{'+' if along[axis] > 0.0 else '-'}{'xyz'[axis]}"}
    return {"normal": [round(float(x), 6) for x in along]}


def box_of(points: FloatArray, grid: float) -> list[list[float]]:
    """Return a box round points, rounded outwards [m]."""
    digits = round(-math.log10(grid))
    low = np.floor(points.min(axis=0) / grid + 1e-6) * grid
    high = np.ceil(points.max(axis=0) / grid - 1e-6) * grid
    return [[round(float(x), digits) + 0.0 for x in corner] for corner in (low, high)]


def surfaces_of(
    selectors: Mapping[str, Any],
    made: Mapping[str, Sequence[int]],
    faces: Sequence[Face],
    tolerance: float = TOLERANCE,
) -> tuple[dict[str, list[int]], dict[str, str]]:
    """Return the faces of named surfaces, and why some selectors find none.

    Args:
        selectors: keys and values by the names of the surfaces.
        made: faces with a name by construction, which selectors do not see.
        faces: of the part.
        tolerance: of lengths [m].
    """
    taken = {number for found in made.values() for number in found}
    left = [index for index in range(len(faces)) if index not in taken]
    named = {name: list(found) for name, found in made.items()}
    wrong = {}
    for name, words in selectors.items():
        try:
            found = chosen(words, [faces[index] for index in left], tolerance)
        except CaseError as error:
            wrong[name] = str(error)
            continue
        numbers = [left[index] for index in found]
        other = next((n for n, had in named.items() if n != name and set(had) & set(numbers)), None)
        if other is not None and other not in made:
            wrong[name] = f"selects a face that has the name {other!r}, and a face has one name"
        named[name] = [*named.get(name, ()), *numbers]
    return named, wrong
