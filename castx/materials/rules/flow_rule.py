"""Declaration of a flow rule for the case file, the manual and the return mapping."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.materials.rules.declaration import check_declaration
from castx.materials.rules.key import RuleKey
from castx.materials.rules.overstress import Overstress
from castx.tables import Table

Values = Mapping[str, FloatArray]
"""Keys of a rule with their values at points, each of shape (points,)."""


def _no_problems(_: Mapping[str, Table]) -> Iterator[tuple[str, str]]:
    yield from ()


@dataclass(frozen=True, kw_only=True)
class FlowRule:
    """Rate at which a material flows at an overstress.

    A file of `castx/materials/flow_rules` holds one rule as `RULE`, which castx finds by itself.

    Attributes:
        name: in the case file and of the file.
        title: name for people, as "Norton's law".
        summary: the rule in one sentence.
        formula: rate of the equivalent viscoplastic strain.
        source: author, year, and where the rule is printed.
        keys: that it reads; keys of one name must be the same in all rules.
        example: values of all keys, of an aluminium alloy at 500 °C.
        threshold: whether the material flows above a yield stress, with hardening, alone; else it
            flows at every stress, so that the rule also serves a liquid.
        overstress: function (values of the keys, temperature [°C], step [s]) that returns V(Δγ).
        flows_by: driving quantity, for the message that a key is missing.
        problems: function that yields keys with values that do not fit together, and the cure.
        is_default: whether a material without `law` follows this rule.
    """

    name: str
    title: str
    summary: str
    formula: str
    source: str
    keys: tuple[RuleKey, ...]
    example: Mapping[str, float]
    threshold: bool
    overstress: Callable[[Values, FloatArray, float], Overstress]
    flows_by: str = "it"
    problems: Callable[[Mapping[str, Table]], Iterator[tuple[str, str]]] = _no_problems
    is_default: bool = False

    def __post_init__(self) -> None:
        check_declaration(self)

    @property
    def needed(self) -> tuple[str, ...]:
        """Keys without default."""
        return tuple(key.name for key in self.keys if key.default is None)

    def tables(self, material: object) -> dict[str, Table]:
        """Return the given keys of the rule as tables, read from the description of a material."""
        found = {key.name: getattr(material, key.name) for key in self.keys}
        return {name: table for name, table in found.items() if table is not None}

    def over_step(self, material: object, temperature: FloatArray, step: float) -> Overstress:
        """Return V(Δγ) of a material that has all keys the rule needs.

        Args:
            material: description with the keys of the rule.
            temperature: [°C], shape (points,).
            step: Δt [s].
        """
        values = {name: table(temperature) for name, table in self.tables(material).items()}
        return self.overstress(values, temperature, step)

    def example_overstress(self, rate: FloatArray, temperature: float = 500.0) -> FloatArray:
        """Return the overstress [Pa] of the example at rates [1/s], in their shape.

        Args:
            rate: of the equivalent viscoplastic strain [1/s].
            temperature: [°C].
        """
        values = {name: np.full_like(rate, value) for name, value in self.example.items()}
        return self.overstress(values, np.full_like(rate, temperature), 1.0)(rate)
