"""The geometry: a generator of `castx.meshes` with its arguments, a mesh file, or CAD files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import prod
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, GetJsonSchemaHandler, PlainValidator, StrictStr, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from castx.case.cad.geometry import CadGeometry, is_cad_file
from castx.errors import CaseError
from castx.input.entries import Choice, Description, Quantity
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.registry import declarations
from castx.input.units import LENGTH, PURE_NUMBER
from castx.meshes.generators.declaration import (
    COMMON_ARGUMENTS,
    MODELS,
    Argument,
    ArgumentKind,
    Generator,
)

AUTO = "auto"
"""Size of the cells at an interface that follows from the skin that freezes there."""
_AXES = {"3d": ("x", "y", "z"), "axisymmetric": ("r", "z")}
_PLANE_AXES = ("x", "y")
_GENERATORS_LATER = ("plate_in_mould", "wheel_in_die", "engine_block_in_die")
_MOST_CELLS = 2e8
_MOST_LENGTHS = 100
_LENGTH = Quantity(LENGTH, above=0.0)

GENERATORS: Mapping[str, Generator] = declarations(
    "castx.meshes.generators", "GENERATOR", Generator, ("declaration",), hyphens=False
)
"""The generators of `castx.meshes.generators` by the words of a case file."""


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise CaseError("true or false is needed")
    return value


def _sides(value: Any) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or len(value) not in (2, 3):
        raise CaseError("two lengths [width, height] are needed, and the depth as third in 3-D")
    return _each_length(value)


def _lengths(value: Any) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= _MOST_LENGTHS:
        raise CaseError(f"a list of 2 to {_MOST_LENGTHS} lengths is needed")
    return _each_length(value)


def _each_length(values: Sequence[Any]) -> tuple[float, ...]:
    found = []
    for index, value in enumerate(values):
        try:
            found.append(_LENGTH.read(value))
        except CaseError as error:
            raise refuse(str(error), index) from None
    return tuple(found)


def _length_or_auto(value: Any) -> float | str:
    return value if value == AUTO else _LENGTH.read(value)


_READERS: Mapping[ArgumentKind, Callable[[Any], Any]] = {
    ArgumentKind.LENGTH: _LENGTH.read,
    ArgumentKind.LENGTH_OR_ZERO: Quantity(LENGTH, least=0.0).read,
    ArgumentKind.LENGTH_OR_AUTO: _length_or_auto,
    ArgumentKind.SIDES: _sides,
    ArgumentKind.LENGTHS: _lengths,
    ArgumentKind.EXPONENT: Quantity(PURE_NUMBER, above=0.0, most=10.0).read,
    ArgumentKind.YES_OR_NO: _truth,
}


def read_argument(argument: Argument, value: Any) -> Any:
    """Return the value of an argument of a generator in SI.

    Raises:
        CaseError: it is not of the kind of the argument.
    """
    if argument.kind is ArgumentKind.CHOICE:
        return Choice(argument.choices).read(value)
    return _READERS[argument.kind](value)


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


def _told(argument: Argument, before: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return the schema of an argument, whose name another key may have too."""
    said = "" if before is None else str(before.get("description", ""))
    meaning = argument.meaning
    if not said or meaning in said:
        return {"description": said or meaning}
    beside_cad = "title" in (before or {})
    return {"description": f"{said}{'; of generators: ' if beside_cad else ', or '}{meaning}"}


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

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the schema of the file, in which the keys of generators and CAD stand beside."""
        schema = handler.resolve_ref_schema(handler(core))
        own = {key: schema["properties"][key] for key in ("model", "file")}
        (cad, _) = schema["properties"]["cad"]["anyOf"]
        beside = dict(handler.resolve_ref_schema(cad)["properties"])
        for arguments in (COMMON_ARGUMENTS, *(found.arguments for found in GENERATORS.values())):
            beside |= {key: _told(argument, beside.get(key)) for key, argument in arguments.items()}
        generators = {
            "generator": {
                "type": "string", "enum": sorted(GENERATORS),
                "description": "of the mesh, in place of a file",
            }
        }  # fmt: skip
        schema["properties"] = own | generators | beside
        schema["properties"]["file"] = {
            "type": "string",
            "description": "a gmsh mesh or CAD solids, relative to the case file",
        }
        return schema

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
            description["arguments"], problems = read_arguments(generator, model, given)
        if problems:
            raise Refusal(problems)
        return description

    @property
    def moduli(self) -> Mapping[str, float]:
        """Volume over surface of bodies that may be cast, of a generated mesh [m]."""
        if self.generator is None:
            return {}
        return GENERATORS[self.generator].moduli(self.arguments, self.model)

    @property
    def wants_interface_size(self) -> bool:
        """Whether castx has to find the size of the cells at the interface."""
        return bool(self.arguments.get("interface_size") == AUTO)

    def with_interface_size(self, size: float | None) -> Geometry:
        """Return the geometry with a size of the cells at the interface [m], or without one."""
        others = {key: a for key, a in self.arguments.items() if key != "interface_size"}
        given = {} if size is None else {"interface_size": size}
        return self.model_copy(update={"arguments": others | given})

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
    def surfaces(self) -> Mapping[str, tuple[str, ...]] | None:
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
        for argument, text in generator.problems(self.arguments, self.model):
            yield Problem((argument,), text)
        yield from self._size_problems(generator)

    def _size_problems(self, generator: Generator) -> Iterator[Problem]:
        size, finer = self.arguments["size"], self.arguments.get("interface_size")
        if finer is not None and finer != AUTO and finer > size:
            yield Problem(("interface_size",), f"must not exceed size, {size:g} m")
        extents = generator.outer_dimensions(self.arguments)
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


def read_arguments(
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
                arguments[name] = read_argument(known[name], value)
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
