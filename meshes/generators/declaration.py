"""What the file of a generator declares: its arguments, models, surfaces and extents."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any, Self

from castx.meshes.linear_mesh import QUADRILATERALS, SIMPLICES
from castx.meshes.model import symmetry_plane

PLANE_MODELS = ("plane-strain", "plane-stress", "generalised-plane-strain")
MODELS = ("3d", "axisymmetric", *PLANE_MODELS)
SYMMETRY_PLANES = (symmetry_plane(0), symmetry_plane(1))

Arguments = Mapping[str, Any]
"""Values of arguments in SI, by name."""


class ArgumentKind(Enum):
    """Kinds of values that an argument may have.

    LENGTH: positive.
    LENGTH_OR_ZERO: positive or 0.
    LENGTH_OR_AUTO: positive, or "auto": castx finds it.
    SIDES: width, height and, in space, depth.
    LENGTHS: two or more lengths.
    EXPONENT: a number above 0 and up to 10.
    YES_OR_NO: true or false.
    CHOICE: one of some words.
    """

    LENGTH = "length"
    LENGTH_OR_ZERO = "length or zero"
    LENGTH_OR_AUTO = "length or auto"
    SIDES = "sides"
    LENGTHS = "lengths"
    EXPONENT = "exponent"
    YES_OR_NO = "yes or no"
    CHOICE = "choice"


@dataclass(frozen=True)
class Argument:
    """An argument of a generator.

    Attributes:
        kind: of its values.
        meaning: what it is, in a few words.
        example: a value in SI; of sides with a depth.
        needed: models in which it must be given.
        models: models in which it may be given.
        choices: the words that are allowed, of a choice.
    """

    kind: ArgumentKind
    meaning: str = ""
    example: Any = None
    needed: tuple[str, ...] = MODELS
    models: tuple[str, ...] = MODELS
    choices: tuple[str, ...] = ()

    def of(self, meaning: str, example: Any, needed: tuple[str, ...] | None = None) -> Self:
        """Return an argument of the same kind.

        Args:
            meaning: what it is.
            example: a value in SI.
            needed: models in which it must be given; None: as before.
        """
        needed = self.needed if needed is None else needed
        return replace(self, meaning=meaning, example=example, needed=needed)

    def example_in(self, model: str) -> Any:
        """Return the example in a model."""
        if self.kind is ArgumentKind.SIDES:
            return list(self.example)[: 3 if model == "3d" else 2]
        return self.example


LENGTH = Argument(ArgumentKind.LENGTH)
LENGTH_OR_ZERO = Argument(ArgumentKind.LENGTH_OR_ZERO, needed=())
SIDES = Argument(ArgumentKind.SIDES)
LENGTH_OR_AUTO = Argument(ArgumentKind.LENGTH_OR_AUTO, needed=())
LENGTHS = Argument(ArgumentKind.LENGTHS)
YES_OR_NO = Argument(ArgumentKind.YES_OR_NO, needed=())
DEPTH = Argument(ArgumentKind.LENGTH, "extent in z", 0.03, needed=("3d",), models=("3d",))
SECTOR = Argument(
    ArgumentKind.CHOICE,
    "part that is meshed, a half in x ≥ 0",
    "quarter",
    needed=(),
    models=("3d",),
    choices=("full", "half", "quarter"),
)

COMMON_ARGUMENTS: Mapping[str, Argument] = {
    "size": LENGTH.of("of the elements", 0.01),
    "interface_size": LENGTH_OR_AUTO.of('of the elements at the interface, or "auto"', 0.005),
    "order_of_growth": Argument(
        ArgumentKind.EXPONENT, "exponent by which sizes grow away from it", 1.0, needed=()
    ),
    "cells": Argument(
        ArgumentKind.CHOICE,
        "triangles and tetrahedra, or quadrilaterals and hexahedra",
        SIMPLICES,
        needed=(),
        choices=(SIMPLICES, QUADRILATERALS),
    ),
}
"""Arguments of every generator."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Generator:
    """A geometry as a case file asks for it, declared beside the function that meshes it.

    A file of `meshes/generators` holds one as `GENERATOR`, which castx finds by itself.

    Attributes:
        mesh: the function; its name is that of the file and of the generator.
        summary: the geometry in one sentence.
        models: models it can be meshed for.
        arguments: its own arguments by name; every generator also takes `COMMON_ARGUMENTS`.
        surfaces: by body; which of them exist depends on model and arguments.
        extents: from the arguments to the outer dimensions in the plane, or in space [m].
        moduli: from arguments and model to volume over surface, without planes of symmetry, of
            each body that may be cast against another one [m].
        problems: yields contradictions of the arguments in a model, by argument.
    """

    mesh: Callable[..., None]
    summary: str = ""
    models: tuple[str, ...] = ()
    arguments: Mapping[str, Argument] = field(default_factory=dict)
    surfaces: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    extents: Callable[[Arguments], list[float]] | None = None
    moduli: Callable[[Arguments, str], Mapping[str, float]] = lambda arguments, model: {}
    problems: Callable[[Arguments, str], Iterator[tuple[str, str]]] = (
        lambda arguments, model: iter(())
    )

    def __post_init__(self) -> None:
        """Refuse a generator that is not declared completely.

        Raises:
            TypeError: with what is missing.
        """
        required = ("summary", "models", "arguments", "surfaces", "extents")
        missing = [name for name in required if not getattr(self, name)]
        missing += [
            f"meaning or example of {name!r}"
            for name, argument in self.arguments.items()
            if not argument.meaning or argument.example is None
        ]
        if missing:
            raise TypeError(f"the generator {self.name!r} declares no {', no '.join(missing)}")

    @property
    def name(self) -> str:
        """Word of the case file."""
        return self.mesh.__name__

    def outer_dimensions(self, arguments: Arguments) -> list[float]:
        """Return the outer dimensions of the bodies together [m].

        Args:
            arguments: in SI.
        """
        assert self.extents is not None
        return self.extents(arguments)

    def example(self, model: str) -> dict[str, Any]:
        """Return the geometry as a case gives it, with a value for each argument of use.

        Args:
            model: one of its models.
        """
        own = {
            name: argument.example_in(model)
            for name, argument in self.arguments.items()
            if model in (argument.needed or argument.models)
        }
        size = COMMON_ARGUMENTS["size"].example
        return {"generator": self.name, "model": model, "size": size, **own}
