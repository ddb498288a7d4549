"""The gap heat laws that a case can choose, found in `castx/transfer/laws`."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple, TypeVar

from pydantic import create_model

from castx.input.entries import Description
from castx.input.registry import declarations
from castx.transfer.declaration import GapHeatLaw, HeatKey

D = TypeVar("D", bound=Description)


@cache
def gap_heat_laws() -> dict[str, GapHeatLaw]:
    """Return all laws by name.

    >>> import castx
    >>> series = castx.gap_heat_laws()["series"]
    >>> series.formula
    'h = 1/(1/closed + g/k) + (1/R)(p/H_e)^b'
    >>> [key.name for key in series.needed]
    ['closed', 'gas_conductivity']

    Raises:
        TypeError: the file of a law does not declare it completely, or two laws declare keys of one
            name that are read in different ways.
    """
    laws = declarations("castx.transfer.laws", "LAW", GapHeatLaw)
    law_keys(laws)
    return laws


def law_keys(laws: dict[str, GapHeatLaw]) -> dict[str, HeatKey[object]]:
    """Return the keys of laws by name.

    Raises:
        TypeError: two laws read keys of one name in different ways.
    """
    keys: dict[str, HeatKey[object]] = {}
    for law in laws.values():
        for key in law.keys:
            if keys.setdefault(key.name, key).entry != key.entry:
                text = f"declares the key {key.name!r} otherwise than another law does"
                raise TypeError(f"the gap heat law {law.name!r} {text}")
    return keys


def with_keys_of_laws(model: type[D]) -> type[D]:
    """Return a description that has a field for every key of every law."""
    own: dict[str, Any] = {
        name: (key.annotation, key.default)
        for name, key in law_keys(gap_heat_laws()).items()
        if name not in model.model_fields
    }
    if not own:
        return model
    return create_model(
        model.__name__,
        __base__=model,
        __module__=model.__module__,
        __doc__=model.__doc__,
        **own,
    )


class LawRow(NamedTuple):
    """A gap heat law as a row of a table for the manual.

    Attributes:
        name: as a case file writes it.
        summary: in one sentence.
        needed: keys without which there is no law, with units: "closed [W/m²/K]".
        useful: keys that it can use besides.
        formula: of the coefficient.
        source: author, section.
    """

    name: str
    summary: str
    needed: str
    useful: str
    formula: str
    source: str


def law_table() -> tuple[LawRow, ...]:
    """Return the table of all laws for the manual."""
    return tuple(
        LawRow(
            law.name,
            law.summary,
            ", ".join(key.text for key in law.needed),
            ", ".join(key.text for key in law.useful),
            law.formula,
            law.source,
        )
        for law in gap_heat_laws().values()
    )
