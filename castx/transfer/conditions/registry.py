"""The heat conditions that a case can choose, found in `castx/transfer/conditions`."""

from __future__ import annotations

from functools import cache

from castx.input.registry import declarations
from castx.transfer.conditions.declaration import HeatConditionKind

OTHERS = ("declaration", "keys", "registry")
"""Files of the room that declare no condition."""


@cache
def heat_conditions() -> dict[str, HeatConditionKind]:
    """Return all heat conditions by name.

    >>> from castx.transfer.conditions.registry import heat_conditions
    >>> heat_conditions()["convection"].formula
    'q = h·(T_ambient(t) − T)'

    Raises:
        TypeError: a file does not declare its condition completely.
    """
    return declarations("castx.transfer.conditions", "CONDITION", HeatConditionKind, OTHERS)


def key_names() -> tuple[str, ...]:
    """Return the names of the keys of all heat conditions, each once."""
    keys = (key.name for kind in heat_conditions().values() for key in kind.keys)
    return tuple(dict.fromkeys(keys))
