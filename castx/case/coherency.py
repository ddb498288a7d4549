"""Coherency: the solid fraction from which the mush of an alloy bears, on which answers hang."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from castx.case.bodies import Body
from castx.case.case import Case
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.sources import properties

_PROPERTY = "liquid.coherency"


@dataclass(frozen=True)
class Coherency:
    """The coherency of a body that freezes over a range of temperatures.

    Attributes:
        body: its name.
        material: name of its alloy.
        value: solid fraction from which its mush bears.
        source: of the number.
    """

    body: str
    material: str
    value: float
    source: str

    @property
    def text(self) -> str:
        """The number with its source."""
        return (
            f"{self.body}: the mush of {self.material} bears from a solid fraction (coherency) of "
            f"{self.value:g} on; {self.source}"
        )


def coherencies(case: Case) -> list[Coherency]:
    """Return the coherency of each body on whose coherency the answers of a case hang.

    That is none without mechanics, where metal freezes at one temperature or starts solid, and in
    bodies that are rigid or without a liquid.
    """
    if case.coupling.scheme == "thermal":
        return []
    found = ((body, find_material(body.material, case.materials)) for body in case.bodies)
    return [
        coherency
        for body, material in found
        if (coherency := coherency_of(body, material)) is not None
    ]


def coherency_of(body: Body, material: Material) -> Coherency | None:
    """Return the coherency of a body, None where it has no meaning."""
    liquid, solid = material.liquid, body.starts_solid(material.description)
    if liquid is None or material.is_isothermal or solid or body.law == "rigid":
        return None
    rows = properties(material.description, material.sources)
    source = next(row.source for row in rows if row.name == _PROPERTY)
    return Coherency(body.name, body.material, liquid.coherency, source)


def coherency_records(case: Case) -> dict[str, dict[str, Any]]:
    """Return coherency and source of each body that has one, by its name, as run.json has them."""
    return {
        found.body: {"value": found.value, "source": found.source} for found in coherencies(case)
    }


def sensitivity_command(case_file: str) -> str:
    """Return the command that shows how much the answers of a case hang on coherency."""
    return f"castx run {case_file} --sensitivity coherency"
