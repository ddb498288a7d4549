"""The key `viscosity` of flow rules in which an overstress drives the flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from castx.input.entries import over_temperature
from castx.input.units import VISCOSITY as PASCAL_SECONDS
from castx.materials.rules.key import PeoplesUnit, RuleKey
from castx.tables import Table

_VISCOSITY = over_temperature(PASCAL_SECONDS, above=0.0)


@dataclass(frozen=True, eq=False)
class TableInPascalSeconds(Table):
    """A viscosity that was written with its unit, Pa·s."""


class ViscosityEntry:
    """A viscosity: a plain number in Pa·s^(1/exponent), or a number with the unit Pa·s."""

    def read(self, value: Any) -> Table:
        """Return the table; `TableInPascalSeconds` if a unit of Pa·s was given.

        Raises:
            CaseError: not a positive number or a table of positive numbers.
        """
        table = _VISCOSITY.read(value)
        rows = value if isinstance(value, list | tuple) else [(None, value)]
        if isinstance(value, Table) or not any(isinstance(row[1], str) for row in rows):
            return table
        return TableInPascalSeconds(table.arguments, table.values)


VISCOSITY = RuleKey(
    "viscosity",
    "viscosity η",
    ViscosityEntry(),
    written_unit="Pa s^(1/exponent)",
    shown=PeoplesUnit("MPa s^(1/n)", 1e-6),
)
