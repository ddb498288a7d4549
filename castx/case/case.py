"""The case: everything that a case file asks for, as one frozen and validated description."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, PrivateAttr

from castx.case.bodies import Body
from castx.case.boundaries import Boundary, Loads, Support
from castx.case.control import Coupling, Solver, Time
from castx.case.geometry import Geometry
from castx.case.interfaces import Interface
from castx.case.output import Foundry, Measurement, Output, Probe
from castx.case.stages import Stage
from castx.errors import CaseError
from castx.input.entries import Description, MaterialName
from castx.materials.description import MaterialDescription

_LONGEST_TITLE = 200
_MOST_BODIES = 100
_MOST_ENTRIES = 1000
_MOST_STAGES = 100
STUDIES = ("vary", "identify", "optimise")
"""Tables of a case file on many runs of it; a single run has no use of them."""


def _title(value: Any) -> str:
    if not isinstance(value, str) or len(value) > _LONGEST_TITLE or not value.isprintable():
        raise CaseError(f"a text in quotes of at most {_LONGEST_TITLE} characters is needed")
    return value


class Case(Description):
    """A whole case in SI units and °C.

    >>> import castx
    >>> case = castx.load_case("cylinder.toml")
    >>> [body.material for body in case.bodies]
    ['Al-pure', 'steel-H13']
    >>> case.interfaces[0].name, case.time.end
    ('casting/mould', 90.0)

    Attributes:
        name: title of the case, by default the name of its file.
        geometry: a generator with its arguments, or a mesh file.
        materials: those that the case describes itself, by name.
        bodies: at least one.
        interfaces: contact and heat transfer between bodies.
        boundaries: conditions on the outer surfaces.
        loads: forces on all bodies.
        support: of bodies that nothing else constrains.
        time: span and steps.
        coupling: of heat and mechanics within a step.
        solver: linear and nonlinear solvers.
        output: fields and checkpoints.
        foundry: how the quantities of the foundry are taken.
        probes: points whose quantities are recorded.
        measurements: measured curves that the report compares with those of probes.
        stages: changes in the course of the process.
    """

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
    foundry: Foundry = Foundry()
    probes: tuple[Probe, ...] = Field((), max_length=_MOST_ENTRIES)
    measurements: tuple[Measurement, ...] = Field((), max_length=_MOST_ENTRIES)
    stages: tuple[Stage, ...] = Field((), max_length=_MOST_STAGES)

    _path: Path = PrivateAttr(Path("case"))
    _digest: str = PrivateAttr("")
    _content: str = PrivateAttr("{}")

    @classmethod
    def model_json_schema(cls, *arguments: Any, **settings: Any) -> dict[str, Any]:
        """Return the JSON schema of a case file, in which tables on many runs may stand too."""
        schema = super().model_json_schema(*arguments, **settings)
        studies = {name: {"type": "object", "description": "on many runs"} for name in STUDIES}
        return schema | {"properties": schema["properties"] | studies}

    @property
    def path(self) -> Path:
        """The case file."""
        return self._path

    @property
    def rigid_bodies(self) -> tuple[str, ...]:
        """Names of the bodies that do not deform."""
        return tuple(body.name for body in self.bodies if body.law == "rigid")

    @property
    def digest(self) -> str:
        """Hash (SHA-256) of `content`; layout and comments do not count."""
        return self._digest

    @property
    def content(self) -> dict[str, Any]:
        """Keys and values of the file, with overrides and data of interfaces from the database.

        They have the types of JSON.
        """
        content: dict[str, Any] = json.loads(self._content)
        return content

    def with_source(self, path: Path, content: Mapping[str, Any]) -> Case:
        """Return the same case with the file and the content it was read from.

        Args:
            path: the case file.
            content: keys and values of the file, with overrides and what it takes from elsewhere.
        """
        canonical = json.dumps(content, sort_keys=True, default=str)
        case = self.model_copy()
        case._path, case._content = path, canonical
        case._digest = sha256(canonical.encode()).hexdigest()
        return case
