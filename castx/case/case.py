"""The case: everything a case file asks for, as one frozen and validated description."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, PrivateAttr

from castx.case.bodies import Body
from castx.case.boundaries import Boundary, Loads, Support
from castx.case.control import Coupling, Solver, Time
from castx.case.geometry import Geometry
from castx.case.interfaces import Interface
from castx.case.output import Output, Probe
from castx.case.reading.between_parts import case_problems, gravity_along
from castx.case.reading.stages import stage_problems
from castx.case.stages import Stage
from castx.errors import CaseError
from castx.input.entries import Description, MaterialName
from castx.input.overrides import apply_overrides
from castx.input.problems import Problem, Refusal, summary
from castx.materials.description import MaterialDescription

_LARGEST_FILE = 4_000_000  # bytes
_LONGEST_TITLE = 200
_DEEPEST = 20  # levels of nesting
_MOST_BODIES = 100
_MOST_ENTRIES = 1000
_MOST_STAGES = 100


def _title(value: Any) -> str:
    if not isinstance(value, str) or len(value) > _LONGEST_TITLE or not value.isprintable():
        raise CaseError(f"a text in quotes of at most {_LONGEST_TITLE} characters is needed")
    return value


class Case(Description):
    """A whole case in SI units and °C; every attribute bears the name of its key."""

    name: Annotated[str, PlainValidator(_title)] = ""
    geometry: Geometry
    materials: dict[MaterialName, MaterialDescription] = Field({}, max_length=_MOST_ENTRIES)
    bodies: tuple[Body, ...] = Field(min_length=1, max_length=_MOST_BODIES)
    interfaces: tuple[Interface, ...] = Field((), max_length=_MOST_ENTRIES)
    boundaries: tuple[Boundary, ...] = Field((), max_length=_MOST_ENTRIES)
    loads: Loads = Loads()
    support: Support = Support()
    time: Time
    coupling: Coupling = Coupling()
    solver: Solver = Solver()
    output: Output = Output()
    probes: tuple[Probe, ...] = Field((), max_length=_MOST_ENTRIES)
    stages: tuple[Stage, ...] = Field((), max_length=_MOST_STAGES)

    _path: Path = PrivateAttr(Path("case"))
    _digest: str = PrivateAttr("")
    _content: str = PrivateAttr("{}")

    @property
    def path(self) -> Path:
        """The case file."""
        return self._path

    @property
    def digest(self) -> str:
        """Hash (SHA-256) of the content, overrides included; layout and comments do not count."""
        return self._digest

    @property
    def content(self) -> dict[str, Any]:
        """Keys and values of the file, overrides included, as JSON knows them."""
        content: dict[str, Any] = json.loads(self._content)
        return content

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield all contradictions between the parts."""
        yield from case_problems(self)
        yield from stage_problems(self)


def load_case(path: Path, overrides: Sequence[str] = ()) -> Case:
    """Read a case file.

    Args:
        path: a TOML file as described in the contract of case files.
        overrides: values that replace those of the file, such as "time.end=10".

    Raises:
        CaseError: the file cannot be read or accepted; the message shows all problems found.
    """
    data = apply_overrides(_read_file(path), overrides)
    return read_case(data, path, " ".join(f"--set {override}" for override in overrides))


def read_case(data: Mapping[str, Any], path: Path, remark: str = "") -> Case:
    """Return the case that keys and values describe, as a TOML reader or a script hands them out.

    Args:
        data: content of a case file.
        path: of the case file; mesh and field files are relative to its folder.
        remark: shown behind the path in messages.

    Raises:
        CaseError: the content cannot be accepted; the message shows all problems found.
    """
    try:
        case = Case.read(data)
    except Refusal as refusal:
        raise CaseError(summary(f"{path} {remark}".strip(), refusal.problems, data)) from None
    return _settled(case, data, path)


def _settled(case: Case, data: Mapping[str, Any], path: Path) -> Case:
    """Return the case with absolute paths, gravity in the model's directions, and its hash."""
    geometry, output = case.geometry, case.output
    if geometry.file is not None:
        file = path.resolve().parent / geometry.file
        geometry = geometry.model_copy(update={"file": file})
    given = "folder" in output.model_fields_set
    folder = Path.cwd() / (output.folder if given else Path("results") / path.stem)
    gravity = gravity_along(case.loads.gravity, geometry.model)
    settled = case.model_copy(
        update={
            "name": case.name or path.stem,
            "geometry": geometry,
            "output": output.model_copy(update={"folder": folder}),
            "loads": case.loads.model_copy(update={"gravity": gravity}),
            "bodies": tuple(
                body.model_copy(update={"temperature": body.temperature.beside(path)})
                for body in case.bodies
            ),
        }
    )
    canonical = json.dumps(data, sort_keys=True, default=str)
    settled._path, settled._content = path, canonical
    settled._digest = sha256(canonical.encode()).hexdigest()
    return settled


def _read_file(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST_FILE + 1)
    except OSError as error:
        raise CaseError(f"{path}: cannot be read: {error.strerror}") from None
    if len(content) > _LARGEST_FILE:
        raise CaseError(f"{path}: too large; a case file has at most {_LARGEST_FILE} bytes")
    try:
        data = tomllib.loads(content.decode())
    except UnicodeDecodeError as error:
        raise CaseError(f"{path}: not a text file in UTF-8 (byte {error.start})") from None
    except ValueError as error:
        raise CaseError(f"{path}: not a TOML file: {error}") from None
    except RecursionError:
        data = None
    if data is None or _deeper_than(_DEEPEST, data):
        raise CaseError(f"{path}: lists or tables are nested more than {_DEEPEST} levels deep")
    return data


def _deeper_than(levels: int, data: Any) -> bool:
    """Whether tables and lists are nested more than some levels deep, found without recursion."""
    layer = [data]
    for _ in range(levels):
        inside = [value for item in layer for value in _items(item)]
        layer = [value for value in inside if isinstance(value, dict | list)]
    return bool(layer)


def _items(container: Any) -> Iterable[Any]:
    return container.values() if isinstance(container, dict) else container
