"""The keys of a material that say how its solid yields, hardens and creeps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from castx.errors import CaseError
from castx.input.entries import Description, Quantity, Tabulated, over_temperature
from castx.input.problems import Problem
from castx.input.units import NORTON_COEFFICIENT, PURE_NUMBER, STRESS, VISCOSITY
from castx.tables import Table

if TYPE_CHECKING:
    from castx.materials.description import MaterialDescription

LAW_KEYS = {
    "perzyna": ("viscosity", "exponent"),
    "bingham": ("viscosity",),
    "norton": ("coefficient", "exponent", "activation_energy"),
}
"""The laws of viscous flow with the keys that each reads."""

RATE_KEYS = tuple(dict.fromkeys(key for keys in LAW_KEYS.values() for key in keys))

ZERO = Table.constant(0.0)
ONE = Table.constant(1.0)

EXPONENT = over_temperature(PURE_NUMBER, above=0.0)
_HARDENING = over_temperature(STRESS, least=0.0)
_VISCOSITY = over_temperature(VISCOSITY, above=0.0)


class Hardening(Description):
    """Isotropic hardening R = linear ξ + saturation (1 − exp(−rate ξ)), over temperature."""

    linear: Annotated[Table, _HARDENING] = ZERO
    saturation: Annotated[Table, _HARDENING] = ZERO
    rate: Annotated[Table, over_temperature(PURE_NUMBER, above=0.0)] = ZERO

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield saturation without rate, rate without saturation, and nothing at all."""
        given = self.model_fields_set
        for key, other in (("saturation", "rate"), ("rate", "saturation")):
            if other in given and key not in given:
                yield Problem((key,), f"missing; it is needed with {other} (Voce)")
        if not given:
            yield Problem((), "needs linear, or saturation and rate (Voce)")

    @property
    def acts(self) -> bool:
        """Whether there is any hardening."""
        return bool(self.linear.values.any() or self.saturation.values.any())


class HardeningEntry:
    """A linear modulus or the keys of `Hardening`, for `Annotated[Hardening, ...]`."""

    def read(self, value: Any) -> Hardening:
        """Return the hardening.

        Raises:
            CaseError: a key, a number or a table is refused.
        """
        if isinstance(value, dict):
            return Hardening.read(value)
        return value if isinstance(value, Hardening) else Hardening(linear=_HARDENING.read(value))

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True, eq=False)
class TableInPascalSeconds(Table):
    """A viscosity that was written with its unit, Pa·s."""


class ViscosityEntry:
    """A viscosity in Pa·s^(1/exponent), plain, or in Pa·s with its unit, for `Annotated[...]`."""

    def read(self, value: Any) -> Table:
        """Return the table, of a kind of its own if a unit of Pa·s was given.

        Raises:
            CaseError: not a positive number or a table of them.
        """
        table = _VISCOSITY.read(value)
        rows = value if isinstance(value, list | tuple) else [(None, value)]
        if isinstance(value, Table) or not any(isinstance(row[1], str) for row in rows):
            return table
        return TableInPascalSeconds(table.arguments, table.values)

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class PlainQuantity(Quantity):
    """A number whose unit depends on other keys, so that it cannot be written with it."""

    def read(self, value: Any) -> float:
        """Return the number.

        Raises:
            CaseError: it is not a plain number, or out of range.
        """
        if isinstance(value, str):
            text = "its unit depends on the exponent n"
            raise CaseError(f"a plain number in {self.dimension.unit} is needed: {text}")
        return super().read(value)


COEFFICIENT = Tabulated(PlainQuantity(NORTON_COEFFICIENT, above=0.0), EXPONENT.over)


def inelastic_problems(material: MaterialDescription) -> Iterator[Problem]:
    """Yield what would be ignored whatever the law of the body, and a unit that does not fit."""
    for key in RATE_KEYS:
        if key in material.model_fields_set and key not in LAW_KEYS[material.law]:
            laws = " or ".join(f'"{law}"' for law, keys in LAW_KEYS.items() if key in keys)
            text = f'acts only with law = {laws}, and here it is "{material.law}"'
            yield Problem((key,), f"{text}; leave it out or change law")
    linear = material.law == "bingham" or bool((material.exponent.values == 1.0).all())
    if isinstance(material.viscosity, TableInPascalSeconds) and not linear:
        text = "a unit of Pa·s fits exponent 1 only; give a plain number in Pa·s^(1/exponent)"
        yield Problem(("viscosity",), text)
    if material.yield_stress is None:
        text = "acts only with yield_stress; add it or leave this key out"
        if material.hardening.acts:
            yield Problem(("hardening",), text)
        if material.kinematic_hardening.values.any():
            yield Problem(("kinematic_hardening",), text)
