"""Faces chosen by words."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos

import numpy as np

from castx.meshes.cad.description import Selector
from castx.meshes.cad.faces import Face

SAME_RADIUS = 1e-3
"""Relative difference of radii that count as equal."""
SHOWN = 30
"""Faces that a refusal lists."""


def named_faces(
    selectors: Sequence[Selector], faces: Sequence[Face], bodies: Sequence[str], rest: str
) -> dict[str, list[Face]]:
    """Return the faces of each named surface.

    Args:
        selectors: of the surfaces.
        faces: of the model.
        bodies: names of all bodies.
        rest: name of the free faces that no selector has.

    Raises:
        ValueError: a selector has no face or names no body, or two have the same face.
    """
    named: dict[str, list[Face]] = {}
    owner: dict[int, str] = {}
    for selector in selectors:
        for name in (selector.body, selector.touches):
            if name is not None and name not in bodies:
                raise ValueError(
                    f"surface {selector.name!r}: no body {name!r}; there are: {', '.join(bodies)}"
                )
        chosen = select(selector, faces)
        for face in chosen:
            if face.tag in owner:
                raise ValueError(
                    f"{owner[face.tag]!r} and {selector.name!r} both select a face, and it has "
                    f"one name: {face.text}; narrow one of them"
                )
            owner[face.tag] = selector.name
        named[selector.name] = chosen
    left = [face for face in faces if len(face.bodies) == 1 and face.tag not in owner]
    if left:
        named[rest] = [*named.get(rest, ()), *left]
    return named


def select(selector: Selector, faces: Sequence[Face]) -> list[Face]:
    """Return the faces that a selector means.

    Raises:
        ValueError: there is none; with those that there are.
    """
    sides = [face for face in faces if _of_its_bodies(selector, face)]
    chosen = [face for face in sides if _fits(selector, face)]
    if selector.largest is not None:
        chosen = sorted(chosen, key=lambda face: -face.area)[: selector.largest]
    if not chosen and sides:
        raise ValueError(f"surface {selector.name!r} selects no face; there are:\n{shown(sides)}")
    if not chosen:
        raise ValueError(f"surface {selector.name!r} selects no face: {_why_none(selector, faces)}")
    return chosen


def _why_none(selector: Selector, faces: Sequence[Face]) -> str:
    """Return why there is no face of the bodies of a selector, and which there are."""
    about = selector.touches or selector.body
    if about is None:
        return "no body has a free face"
    shared = (face for face in faces if len(face.bodies) == 2 and about in face.bodies)
    others = ", ".join(dict.fromkeys(other_body(face, about) for face in shared)) or "no body"
    if selector.touches is not None:
        return f"{about} shares faces with {others}"
    return f'{about} has no free face; touches = "BODY" selects what it shares with {others}'


def shown(faces: Sequence[Face]) -> str:
    """Return a line of text for each face, the largest first."""
    order = sorted(faces, key=lambda face: -face.area)
    lines = [f"  {face.text}" for face in order[:SHOWN]]
    if len(order) > SHOWN:
        lines.append(f"  and {len(order) - SHOWN} smaller ones")
    return "\n".join(lines)


def _of_its_bodies(selector: Selector, face: Face) -> bool:
    if selector.touches is None:
        return len(face.bodies) == 1 and selector.body in (None, face.bodies[0])
    if len(face.bodies) != 2 or selector.touches not in face.bodies:
        return False
    return selector.body is None or selector.body == other_body(face, selector.touches)


def other_body(face: Face, body: str) -> str:
    """Return the body on the other side of a shared face."""
    return face.bodies[1] if face.bodies[0] == body else face.bodies[0]


def _fits(selector: Selector, face: Face) -> bool:
    if selector.normal is not None:
        body = face.bodies[0]
        if selector.touches is not None:
            body = other_body(face, selector.touches)
        along = face.normals_from(body) @ np.array(selector.normal)
        if (along < cos(selector.angle)).any():
            return False
    if selector.radius is not None:
        if face.radius is None or abs(face.radius / selector.radius - 1.0) > SAME_RADIUS:
            return False
    if selector.within is not None:
        lowest, highest = np.array(selector.within)
        outside = (face.points < lowest - selector.tolerance) | (
            face.points > highest + selector.tolerance
        )
        if outside.any():
            return False
    return True
