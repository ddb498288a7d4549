"""The geometry: a generator of `castx.meshes` with its arguments, a mesh file, or CAD files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, StrictStr, model_validator

from castx.case.cad.geometry import CadGeometry, is_cad_file
from castx.errors import CaseError
from castx.input.entries import Choice, Description, Quantity
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import LENGTH, PURE_NUMBER

PLANE_MODELS = ("plane-strain", "plane-stress", "generalised-plane-strain")
MODELS = ("3d", "axisymmetric", *PLANE_MODELS)

_AXES = {"3d": ("x", "y", "z"), "axisymmetric": ("r", "z")}
_PLANE_AXES = ("x", "y")
_GENERATORS_LATER = ("plate_in_mould", "wheel_in_die", "engine_block_in_die")
_MOST_CELLS = 2e8
_LENGTH = Quantity(LENGTH, above=0.0)
_BORE = Quantity(LENGTH, least=0.0)


@dataclass(frozen=True)
class Argument:
    """An argument of a generator.

    Args:
        read: returns the checked value in SI, or raises `CaseError`.
        needed: models in which it must be given.
        models: models in which it may be given.
    """

    read: Callable[[Any], Any]
    needed: tuple[str, ...] = MODELS
    models: tuple[str, ...] = MODELS


@dataclass(frozen=True)
class Generator:
    """Arguments of a generator and names in its mesh.

    Args:
        models: models it can be meshed for.
        arguments: its own arguments by name; every generator also takes `COMMON_ARGUMENTS`.
        surfaces: by body; which of them exist depends on model and arguments.
        extents: outer dimensions in the plane, or in space, from the arguments.
        check: yields contradictions of the arguments, by argument.
    """

    models: tuple[str, ...]
    arguments: dict[str, Argument]
    surfaces: dict[str, tuple[str, ...]]
    extents: Callable[[dict[str, Any]], list[float]]
    check: Callable[[dict[str, Any], str], Iterator[tuple[str, str]]] = field(
        default=lambda arguments, model: iter(())
    )


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise CaseError("true or false is needed")
    return value


def _sides(value: Any) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or len(value) not in (2, 3):
        raise CaseError("two lengths [width, height] are needed, and the depth as third in 3-D")
    sides = []
    for index, side in enumerate(value):
        try:
            sides.append(_LENGTH.read(side))
        except CaseError as error:
            raise refuse(str(error), index) from None
    return tuple(sides)


def _blocks(arguments: dict[str, Any], model: str) -> Iterator[tuple[str, str]]:
    upper, base = arguments["upper"], arguments["base"]
    dimension = 3 if model == "3d" else 2
    for name, sides in (("upper", upper), ("base", base)):
        if len(sides) != dimension:
            yield name, f"the model {model!r} needs {dimension} lengths"
    for index, what in ((0, "wide"), (2, "deep")):
        if len(upper) == len(base) > index and upper[index] > base[index] * (1.0 + 1e-9):
            yield "upper", f"the base must be at least as {what} as the upper block"
    if model == "axisymmetric" and not arguments.get("symmetry", True):
        yield "symmetry", "an axisymmetric mesh lies in r >= 0; leave it true"


def _box(arguments: dict[str, Any], model: str) -> Iterator[tuple[str, str]]:
    dimension = 3 if model == "3d" else 2
    if len(arguments["box"]) != dimension:
        yield "box", f"the model {model!r} needs {dimension} lengths"


def _box_extents(arguments: dict[str, Any]) -> list[float]:
    width, height, *depth = arguments["box"]
    walls = 2 * arguments["wall"]
    above = walls if arguments.get("lid", False) else arguments["wall"]
    return [width + walls, height + above, *(side + walls for side in depth)]


def _radii(arguments: dict[str, Any], model: str) -> Iterator[tuple[str, str]]:
    if arguments.get("core_bore", 0.0) >= arguments["core_radius"]:
        yield "core_bore", "must be smaller than core_radius"
    if arguments["core_radius"] >= arguments["outer_radius"]:
        yield "outer_radius", "must be larger than core_radius"


_DEPTH = Argument(_LENGTH.read, needed=("3d",), models=("3d",))
_SECTOR = Argument(Choice(("full", "half", "quarter")).read, needed=(), models=("3d",))
_PLAIN = Argument(_LENGTH.read)
_ROUND = ("symmetry-x", "symmetry-y")
_BAR = ("far", "bottom", "top", "front", "back")

COMMON_ARGUMENTS = {
    "size": _PLAIN,
    "interface_size": Argument(_LENGTH.read, needed=()),
    "order_of_growth": Argument(Quantity(PURE_NUMBER, above=0.0, most=10.0).read, needed=()),
    "cells": Argument(Choice(("simplices", "quadrilaterals")).read, needed=()),
}

GENERATORS = {
    "slab": Generator(
        models=MODELS,
        arguments={"length": _PLAIN, "width": _PLAIN, "depth": _DEPTH},
        surfaces={"casting": ("wall", *_BAR)},
        extents=lambda a: [a["length"], a["width"], *([a["depth"]] if "depth" in a else [])],
    ),
    "two_slabs": Generator(
        models=("3d", *PLANE_MODELS),
        arguments={"length": _PLAIN, "mould_length": _PLAIN, "width": _PLAIN, "depth": _DEPTH},
        surfaces={"casting": _BAR, "mould": _BAR},
        extents=lambda a: [
            a["length"] + a["mould_length"],
            a["width"],
            *([a["depth"]] if "depth" in a else []),
        ],
    ),
    "cylinder_in_mould": Generator(
        models=("3d", "axisymmetric"),
        arguments={
            "radius": _PLAIN,
            "height": _PLAIN,
            "wall": _PLAIN,
            "floor": Argument(_BORE.read, needed=()),
            "sector": _SECTOR,
        },
        surfaces={
            "casting": ("base", "top", *_ROUND),
            "mould": ("outside", "base", "top", *_ROUND),
        },
        extents=lambda a: [a["radius"] + a["wall"], a["height"] + a.get("floor", 0.0)],
    ),
    "stacked_blocks": Generator(
        models=MODELS,
        arguments={
            "upper": Argument(_sides),
            "base": Argument(_sides),
            "symmetry": Argument(_truth, needed=()),
        },
        surfaces={"upper": ("top", "side", *_ROUND), "base": ("bottom", "side", "shelf", *_ROUND)},
        extents=lambda a: [a["base"][0], a["base"][1] + a["upper"][1], *a["base"][2:]],
        check=_blocks,
    ),
    "box_in_mould": Generator(
        models=("3d", *PLANE_MODELS),
        arguments={
            "box": Argument(_sides),
            "wall": _PLAIN,
            "lid": Argument(_truth, needed=()),
        },
        surfaces={"casting": ("top",), "mould": ("outside", "base", "top")},
        extents=_box_extents,
        check=_box,
    ),
    "core_in_ring": Generator(
        models=MODELS,
        arguments={
            "core_radius": _PLAIN,
            "core_bore": Argument(_BORE.read, needed=()),
            "outer_radius": _PLAIN,
            "height": Argument(_LENGTH.read, needed=("3d", "axisymmetric")),
            "sector": _SECTOR,
        },
        surfaces={
            "core": ("bore", "base", "top", *_ROUND),
            "casting": ("outside", "base", "top", *_ROUND),
        },
        extents=lambda a: [a["outer_radius"], a.get("height", a["outer_radius"])],
        check=_radii,
    ),
}


def _generator(value: Any) -> str:
    if value in _GENERATORS_LATER:
        raise CaseError(f"not available yet; {among('', list(GENERATORS), what='available')}")
    return Choice(tuple(GENERATORS)).read(value)


def _mesh_file(value: Any) -> Path:
    if not isinstance(value, str | Path) or not str(value).endswith(".msh") or "\0" in str(value):
        raise CaseError(
            'the path of a gmsh mesh is needed, relative to the case file: "part.msh", or of a CAD '
            'file: "part.step"'
        )
    return Path(value)


class Geometry(Description):
    """A generator with its arguments, a gmsh file, or CAD files.

    Attributes:
        model: "3d", "axisymmetric" or a plane model.
        generator: a name of `GENERATORS`; None: a file.
        file: of the mesh, relative to the case file, after loading absolute.
        cad: CAD files with their keys, which stand beside `model` in the file.
        arguments: of the generator as given, in SI; it has defaults of the others.
    """

    model: Annotated[str, Choice(MODELS)]
    generator: Annotated[str | None, PlainValidator(_generator)] = None
    file: Annotated[Path | None, PlainValidator(_mesh_file)] = None
    cad: CadGeometry | None = None
    arguments: dict[StrictStr, Any] = Field({})

    @model_validator(mode="before")
    @classmethod
    def _gather(cls, data: Any) -> Any:
        """Check the arguments, which stand beside the generator or the CAD file."""
        if not isinstance(data, dict) or isinstance(data.get("model", 0), list | dict):
            return data
        if _is_cad(data):
            return _with_cad(data)
        own = [key for key in cls.model_fields if key not in ("arguments", "cad")]
        description = {key: value for key, value in data.items() if key in own}
        given = {key: value for key, value in data.items() if key not in own}
        generator, model = GENERATORS.get(str(data.get("generator"))), data.get("model")
        if generator is None or model not in generator.models:
            unknown = given if "file" in data else {}
            problems = [
                Problem((key,), f"unknown key; {among(key, own, what='known keys beside a file')}")
                for key in unknown
            ]
        else:
            description["arguments"], problems = _read_arguments(generator, model, given)
        if problems:
            raise Refusal(problems)
        return description

    @property
    def gdim(self) -> int:
        """Number of coordinates."""
        return len(_AXES.get(self.model, _PLANE_AXES))

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates along which numbers may vary."""
        axes = _AXES.get(self.model, _PLANE_AXES)
        return (*axes, "r") if self.model == "3d" else axes

    @property
    def directions(self) -> tuple[str, ...]:
        """Names of the directions of displacements."""
        return (*_AXES.get(self.model, _PLANE_AXES), "normal", "all")

    @property
    def surfaces(self) -> dict[str, tuple[str, ...]] | None:
        """Bodies of a generated mesh with the surfaces they can have; None for a file."""
        return GENERATORS[self.generator].surfaces if self.generator is not None else None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a missing or doubled source of the mesh, and contradictions of its arguments."""
        if [self.generator, self.file, self.cad].count(None) != 2:
            cad = 'or CAD: file = "part.step"'
            yield Problem((), f'give either a generator or a mesh: file = "part.msh", {cad}')
            return
        if self.cad is not None and self.model != "3d":
            yield Problem(("model",), 'CAD solids need the model "3d"')
        if self.generator is None:
            return
        generator = GENERATORS[self.generator]
        if self.model not in generator.models:
            known = among("", generator.models, what="its models")
            yield Problem(("model",), f"{self.generator} is not made for this model; {known}")
            return
        for argument, text in generator.check(self.arguments, self.model):
            yield Problem((argument,), text)
        yield from self._size_problems(generator)

    def _size_problems(self, generator: Generator) -> Iterator[Problem]:
        size = self.arguments["size"]
        if self.arguments.get("interface_size", size) > size:
            yield Problem(("interface_size",), f"must not exceed size, {size:g} m")
        extents = generator.extents(self.arguments)
        extents += [max(extents)] * (self.gdim - len(extents))
        cells = prod(max(extent / size, 1.0) for extent in extents)
        if cells > _MOST_CELLS:
            yield Problem(("size",), f"makes about {cells:.0e} elements; at most {_MOST_CELLS:.0e}")


def _is_cad(data: dict[str, Any]) -> bool:
    return is_cad_file(data.get("file")) or "files" in data or "parts" in data


def _with_cad(data: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a geometry with the keys of CAD files gathered in `cad`."""
    own = {key: value for key, value in data.items() if key in ("model", "generator")}
    given = {key: value for key, value in data.items() if key not in own}
    return {**own, "cad": CadGeometry.read(given)}


def _read_arguments(
    generator: Generator, model: str, given: dict[str, Any]
) -> tuple[dict[str, Any], list[Problem]]:
    """Return the checked arguments, and the problems of the others."""
    known = {**generator.arguments, **COMMON_ARGUMENTS}
    arguments: dict[str, Any] = {}
    problems = []
    for name, value in given.items():
        if name not in known:
            text = f"unknown argument; {among(name, list(known), what='known arguments')}"
            problems.append(Problem((name,), text))
        elif model not in known[name].models:
            text = f"has no meaning in the model {model!r}; leave it out"
            problems.append(Problem((name,), text))
        else:
            try:
                arguments[name] = known[name].read(value)
            except Refusal as error:
                problems.extend(error.inside(name).problems)
            except CaseError as error:
                problems.append(Problem((name,), str(error)))
    for name, argument in known.items():
        if name not in given and model in argument.needed:
            problems.append(Problem((name,), f"missing; the model {model!r} needs it"))
    return arguments, problems


def gravity_along(gravity: Sequence[float], model: str) -> tuple[float, ...]:
    """Return gravity with one number for each direction of the model [m/s²].

    Args:
        gravity: as given: nothing, one number for each direction of the model, or (x, y, z) of
            space, of which only the directions of the model are kept [m/s²].
        model: geometric model.
    """
    if not gravity:
        return (0.0,) * (3 if model == "3d" else 2)
    if model == "axisymmetric" and len(gravity) == 3:
        return (0.0, gravity[2])
    return tuple(gravity if model == "3d" else gravity[:2])
