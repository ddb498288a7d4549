"""Mechanical contact on an interface: method, its numbers, pairing of nodes, initial gap."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Annotated, Any

import numpy.typing as npt
from pydantic import PlainValidator

from castx.arrays import FloatArray
from castx.contact.methods.description import Setting, UnknownKind
from castx.contact.methods.registry import DEFAULT, METHODS, keys, names, users
from castx.errors import CaseError
from castx.input.coordinates import AXES, coordinate
from castx.input.entries import Choice, Description, Quantity, Tabulated, with_entries
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import ANGLE, LENGTH, PURE_NUMBER
from castx.tables import Table

_LENGTHS = Quantity(LENGTH)
NONE = "none"
"""Bodies that do not meet."""
AUTOMATIC = "automatic"
"""Normals that suit what meets at the interface, see `castx.case.reading.normals`."""
AVERAGED = "averaged"
"""One normal for each node, the mean over its facets."""
PATCHES = "patches"
"""A normal for each smooth patch of facets round a node."""


@dataclass(frozen=True)
class Pairing:
    """The rule by which the nodes of an interface find partners and normals.

    Attributes:
        normals: "averaged" over the facets round a node, or one for each of the smooth "patches";
            from node to face the mean of both sides, or that of the "primary" facet.
        sharp_angle: between the normals of neighbouring facets of different patches [rad].
        kind: "node-to-node" for matching meshes, "node-to-face" for others.
        surfaces: from node to face those of the secondary and primary body; None: the shared one.
        meshed_gap: whether the distance of the meshes counts as a gap, from node to face.
        search_distance: beyond which a node faces nothing [m]; None: the size of the mesh there.
    """

    normals: str = AVERAGED
    sharp_angle: float = math.radians(40.0)
    kind: str = "node-to-node"
    surfaces: tuple[str, str] | None = None
    meshed_gap: bool = True
    search_distance: float | None = None

    @property
    def angle_of_patches(self) -> float | None:
        """Angle between the facets of different patches [rad]; None: each node has one pair."""
        return self.sharp_angle if self.normals == PATCHES else None


BY_NODES = Pairing()
"""The default rule."""


@dataclass(frozen=True, eq=False)
class InitialGap:
    """Gap of an interface without displacements [m]; negative is interference.

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


def _with_fallbacks() -> tuple[str, ...]:
    return names(lambda method: method.fallback)


def _fallback(value: Any) -> tuple[str, ...]:
    if not isinstance(value, list | tuple) or len(value) > len(_with_fallbacks()):
        raise CaseError(f"a list of methods is needed; {among('', _with_fallbacks())}")
    for index, name in enumerate(value):
        try:
            Choice(_with_fallbacks()).read(name)
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


@with_entries({key.name: (key.kind.read, key.default) for key in keys().values()})
class InterfaceContact(Description):
    """Mechanical contact of two bodies, and the gap they start with.

    The keys of the methods stand beside these, see `castx.contact.methods`.

    Attributes:
        method: name of the contact method, or `NONE`.
        initial_gap: gap without displacements [m].
        normals: "averaged" over the facets of the interface round each node, or at edges and
            corners one for each of the smooth "patches"; from node to face the mean of both sides
            or that of the "primary" facet, which are one where meshes match. "automatic" is what
            `castx.case.reading.normals` chooses: patches where a liquid meets a wall.
        sharp_angle: facets of one patch enclose less than this angle [°].
        pairing: "node-to-node" for matching meshes, "node-to-face" for others.
        surfaces: from node to face those of the two bodies; None: the surface they share.
        meshed_gap: from node to face, whether a gap or overlap between the meshes is one of the
            bodies, or with "ignored" only that of facets along a common curved surface.
        search_distance: from node to face, beyond which a node faces nothing [m]; None: the longest
            edge of the facets there, on that side where they are longer.
        friction: Coulomb's coefficient μ.
        fallback: methods that take over one after the other for a step in which those before have
            failed.
    """

    method: Annotated[str, Choice((*names(), NONE))] = DEFAULT
    initial_gap: Annotated[InitialGap, PlainValidator(_initial_gap)] = InitialGap(
        Table.constant(0.0)
    )
    normals: Annotated[str, Choice((AUTOMATIC, AVERAGED, "primary", PATCHES))] = AUTOMATIC
    sharp_angle: Annotated[float, Quantity(ANGLE, above=0.0, most=180.0)] = 40.0
    pairing: Annotated[str, Choice(("node-to-node", "node-to-face"))] = "node-to-node"
    surfaces: Annotated[tuple[str, str] | None, PlainValidator(_surfaces)] = None
    meshed_gap: Annotated[str, Choice(("counts", "ignored"))] = "counts"
    search_distance: Annotated[float | None, Quantity(LENGTH, above=0.0)] = None
    friction: Annotated[float, Quantity(PURE_NUMBER, least=0.0, most=10.0)] = 0.0
    fallback: Annotated[tuple[str, ...], PlainValidator(_fallback)] = ()

    def _pairing_problems(self) -> Iterator[Problem]:
        faces = self.pairing == "node-to-face"
        if self.normals not in (AUTOMATIC, AVERAGED) and is_tied(self.method):
            text = f"the method {self.method!r} has no normals; leave it out"
            yield Problem(("normals",), text)
        if "sharp_angle" in self.model_fields_set and self.normals != PATCHES:
            yield Problem(("sharp_angle",), 'belongs to normals = "patches"')
        if faces and self.normals == PATCHES:
            yield Problem(("normals",), 'from node to face only "averaged" and "primary"')
        for key in ("surfaces", "meshed_gap", "search_distance"):
            if key in self.model_fields_set and not faces:
                yield Problem((key,), 'belongs to pairing = "node-to-face"')

    @property
    def pairing_rule(self) -> Pairing:
        """Rule by which nodes find partners and normals."""
        angle = math.radians(self.sharp_angle)
        counts = self.meshed_gap == "counts"
        normals = AVERAGED if self.normals == AUTOMATIC else self.normals
        return Pairing(
            normals, angle, self.pairing, self.surfaces, counts, self.search_distance
        )

    @property
    def settings(self) -> dict[str, Setting]:
        """Values of the keys of the methods by name."""
        return {name: getattr(self, name) for name in keys()}

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield keys that the method or the pairing do not use."""
        yield from self._pairing_problems()
        problem = friction_problem((self.method, *self.fallback), self.pairing_rule, self.friction)
        if problem and self.method != NONE:
            yield Problem(("friction",), problem)
        used = {self.method, *self.fallback}
        for key in keys():
            if key in self.model_fields_set and not used.intersection(users(key)):
                text = among("", users(key), what="methods that do")
                yield Problem((key,), f"the method {self.method!r} does not use it; {text}")
        if self.fallback and self.method not in _with_fallbacks():
            yield Problem(("fallback",), f"the method {self.method!r} has none; leave it out")
        if self.method in self.fallback:
            yield Problem(("fallback",), f"begins with the method {self.method!r} itself")
        if "initial_gap" in self.model_fields_set and is_tied(self.method):
            yield Problem(("initial_gap",), f"the method {self.method!r} has no gap; leave it out")


def is_tied(method: str) -> bool:
    """Return whether a contact method joins the bodies.

    Args:
        method: name of the method, or `NONE`.
    """
    return method != NONE and METHODS[method].unknowns is UnknownKind.TIED


def friction_problem(methods: Collection[str], pairing: Pairing, friction: float) -> str:
    """Return why an interface cannot have friction, or an empty text.

    Args:
        methods: the contact method and those that may take over from it.
        pairing: rule of the interface.
        friction: Coulomb's coefficient μ.
    """
    known = names(lambda method: method.friction)
    without = sorted(set(methods) - set(known))
    if friction == 0:
        return ""
    if without:
        return f"method {without[0]!r} has no friction; those that have: {', '.join(known)}"
    if len(methods) > 1:
        return "what has slipped is known to one method alone; leave fallback out"
    if pairing.kind != "node-to-node" or pairing.normals == PATCHES:
        return 'friction needs pairing = "node-to-node" and one normal for each node, "averaged"'
    return ""


def body_problem(method: str, secondary: str, primary: str, rigid: Collection[str]) -> str:
    """Return why two bodies cannot be in contact by a method, or an empty text.

    Args:
        method: name of the method, or `NONE`.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        rigid: names of the rigid bodies.
    """
    if secondary in rigid and primary in rigid:
        return 'both bodies are rigid; use method = "none"'
    if secondary in rigid:
        return (
            f"the secondary body {secondary!r} is rigid; name the bodies the other way round: "
            f'["{primary}", "{secondary}"]'
        )
    if method != NONE and METHODS[method].rigid_primary and primary not in rigid:
        return (
            f'needs a rigid primary body; give {primary!r} law = "rigid", or use another method '
            f'such as "{DEFAULT}"'
        )
    return ""
