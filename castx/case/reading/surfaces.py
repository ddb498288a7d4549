"""Names of bodies and surfaces that a case uses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from castx.input.problems import KeyPath, Problem, among

if TYPE_CHECKING:
    from castx.case.case import Case


def surface_problems(case: Case, place: KeyPath, body: str, surface: str) -> Iterator[Problem]:
    """Yield a body that the case does not have, or a surface that its generator does not make."""
    names = [known.name for known in case.bodies]
    surfaces = case.geometry.surfaces
    if body not in names:
        yield Problem(place, f"unknown body {body!r}; {among(body, names)}")
    elif surfaces is not None and body in surfaces:
        known = [*surfaces[body], *(name for name in surfaces if name != body)]
        if surface not in known:
            nearest = among(surface, known, what=f"surfaces of {body!r}")
            yield Problem(place, f"no surface {surface!r}; {nearest}")
