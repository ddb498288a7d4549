"""Description of mechanical contact on an interface: method, its numbers, initial gap."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

import numpy.typing as npt
from pydantic import PlainValidator

from castx.arrays import FloatArray
from castx.case.pairing import Pairing
from castx.contact.choice import friction_problem
from castx.errors import CaseError
from castx.input.coordinates import AXES, coordinate
from castx.input.entries import Choice, Description, Quantity, Tabulated, Whole
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import ANGLE, LENGTH, PENALTY, PURE_NUMBER
from castx.tables import Table

_LENGTHS = Quantity(LENGTH)
_WITH_PENALTY = ("penalty", "augmented-lagrangian", "block-iterative")
_FALLBACKS = (
    "condensed",
    "multipliers",
    "penalty",
    "augmented-lagrangian",
    "block-iterative",
)
_METHODS_WITH = {
    "penalty": _WITH_PENALTY,
    "augmentation": ("augmented-lagrangian",),
    "augmentations": ("augmented-lagrangian",),
    "blocks": ("block-iterative",),
    "block_solver": ("block-iterative",),
    "block_iterations": ("block-iterative",),
}


@dataclass(frozen=True, eq=False)
class InitialGap:
    """Gap of an interface before anything moves [m]; negative is interference.

    Args:
        table: metres over the coordinate; constant where there is one number.
        along: coordinate of the table, "x", "y", "z" or "r".
    """

    table: Table
    along: str = "x"

    def at(self, points: npt.ArrayLike) -> FloatArray:
        """Return the gap at points of shape (n, gdim), in the coordinates of the model."""
        return self.table(coordinate(points, self.along))


def _initial_gap(value: Any) -> InitialGap:
    if isinstance(value, InitialGap):
        return value
    if not isinstance(value, dict):
        return InitialGap(Table.constant(_LENGTHS.read(value)))
    for key in value:
        if key not in ("along", "table"):
            raise refuse(f"unknown key; {among(key, ('along', 'table'), what='known keys')}", key)
    for key in ("along", "table"):
        if key not in value:
            raise refuse("missing; both along and table are needed", key)
    try:
        along = Choice(AXES).read(value["along"])
    except CaseError as error:
        raise refuse(str(error), "along") from None
    try:
        return InitialGap(Tabulated(_LENGTHS, _LENGTHS).read(value["table"]), along)
    except Refusal as error:
        raise error.inside("table") from None


def _penalty(value: Any) -> float | str:
    if value == "auto":
        return "auto"
    try:
        return Quantity(PENALTY, above=0.0).read(value)
    except CaseError as error:
        raise CaseError(f'{error}, or "auto"') from None


def _fallback(value: Any) -> tuple[str, ...]:
    if not isinstance(value, list | tuple) or len(value) > len(_FALLBACKS):
        raise CaseError(f"a list of methods is needed; {among('', _FALLBACKS)}")
    for index, name in enumerate(value):
        try:
            Choice(_FALLBACKS).read(name)
        except CaseError as error:
            raise refuse(str(error), index) from None
        if name in value[:index]:
            raise refuse("is there already", index)
    return tuple(value)


def _surfaces(value: Any) -> tuple[str, str] | None:
    names = value if isinstance(value, list | tuple) else ()
    if len(names) != 2 or not all(isinstance(n, str) and 0 < len(n) <= 100 for n in names):
        raise CaseError("two names are needed: the surface of the first body and of the second")
    return (names[0], names[1])


class Contact(Description):
    """How two bodies touch, and the gap they start with.

    `penalty` [Pa/m] belongs to the methods that have one, by default "auto": by the present
    stiffness of the softer side. The augmented Lagrangian method updates its multipliers at most
    `augmentations` times in a solve, after every "iteration" or in a "loop" round the iteration.
    The block-iterative method sweeps at most `block_iterations` times over the `blocks`, the
    "bodies" or their interiors and the "interface", and goes on with the state it has reached; as
    a "preconditioner" one sweep stands for the inverse of the matrix. The methods of `fallback`
    take over one after the other for a step in which those before have failed.

    `normals`: "averaged" over the facets of an interface round each node, or at edges and corners
    one for each of the smooth "patches", whose facets enclose more than the `sharp_angle` [°].
    Meshes that do not match are paired "node-to-face" between two `surfaces`; there the normals are
    the mean of both sides or that of the "primary" facet, which are one where meshes match. A gap
    or overlap between them is one of the bodies, or with `meshed_gap` "ignored" only that of facets
    that follow a common curved surface. `friction` is Coulomb's coefficient.
    """

    method: Annotated[
        str,
        Choice(
            (
                "condensed",
                "multipliers",
                "penalty",
                "augmented-lagrangian",
                "rigid",
                "block-iterative",
                "tied",
                "none",
            ),
        ),
    ] = "condensed"
    initial_gap: Annotated[InitialGap, PlainValidator(_initial_gap)] = InitialGap(
        Table.constant(0.0)
    )
    normals: Annotated[str, Choice(("averaged", "primary", "patches"))] = "averaged"
    sharp_angle: Annotated[float, Quantity(ANGLE, above=0.0, most=180.0)] = 40.0
    pairing: Annotated[str, Choice(("node-to-node", "node-to-face"))] = "node-to-node"
    surfaces: Annotated[tuple[str, str] | None, PlainValidator(_surfaces)] = None
    meshed_gap: Annotated[str, Choice(("counts", "ignored"))] = "counts"
    friction: Annotated[float, Quantity(PURE_NUMBER, least=0.0, most=10.0)] = 0.0
    penalty: Annotated[float | str, PlainValidator(_penalty)] = "auto"
    augmentation: Annotated[str, Choice(("iteration", "loop"))] = "loop"
    augmentations: Annotated[int, Whole(0, 10_000)] = 30
    blocks: Annotated[str, Choice(("bodies", "interface"))] = "bodies"
    block_solver: Annotated[str, Choice(("iteration", "preconditioner"))] = "iteration"
    block_iterations: Annotated[int, Whole(1, 100_000)] = 50
    fallback: Annotated[tuple[str, ...], PlainValidator(_fallback)] = ()

    def _pairing_problems(self) -> Iterator[Problem]:
        faces = self.pairing == "node-to-face"
        if self.normals != "averaged" and self.method == "tied":
            yield Problem(("normals",), "the method 'tied' has no normals; leave it out")
        if "sharp_angle" in self.model_fields_set and self.normals != "patches":
            yield Problem(("sharp_angle",), 'belongs to normals = "patches"')
        if faces and self.normals == "patches":
            yield Problem(("normals",), 'from node to face only "averaged" and "primary"')
        if self.surfaces is not None and not faces:
            yield Problem(("surfaces",), 'belongs to pairing = "node-to-face"')
        if "meshed_gap" in self.model_fields_set and not faces:
            yield Problem(("meshed_gap",), 'belongs to pairing = "node-to-face"')

    @property
    def pairing_rule(self) -> Pairing:
        """How nodes find partners and normals."""
        angle = math.radians(self.sharp_angle)
        counts = self.meshed_gap == "counts"
        return Pairing(self.normals, angle, self.pairing, self.surfaces, counts)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield numbers that the method or the pairing do not use."""
        yield from self._pairing_problems()
        problem = friction_problem((self.method, *self.fallback), self.pairing_rule, self.friction)
        if problem and self.method != "none":
            yield Problem(("friction",), problem)
        used = {self.method, *self.fallback}
        for key, methods in _METHODS_WITH.items():
            if key in self.model_fields_set and not used.intersection(methods):
                yield Problem((key,), f"the method {self.method!r} does not use it; {_users(key)}")
        if self.fallback and self.method in ("rigid", "tied", "none"):
            yield Problem(("fallback",), f"the method {self.method!r} has none; leave it out")
        if self.method in self.fallback:
            yield Problem(("fallback",), f"begins with the method {self.method!r} itself")
        if "initial_gap" in self.model_fields_set and self.method == "tied":
            yield Problem(("initial_gap",), "the method 'tied' has no gap; leave it out")


def _users(key: str) -> str:
    return among("", _METHODS_WITH[key], what="methods that do")
