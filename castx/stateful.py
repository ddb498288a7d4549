"""State as named arrays: what every object that remembers something hands to a checkpoint.

`saved()` returns the committed state of an object, `restore(arrays)` takes it back from the arrays
of the same names, whose rows are then the local entities with their ghosts. Rows are known by
numbers of the mesh before it was distributed, so that the number of ranks may change in between.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from castx.arrays import LongArray

Array = npt.NDArray[Any]
Arrays = Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class Numbering:
    """Entities on this rank by numbers that do not depend on the ranks.

    Attributes:
        name: of the kind of entity, such as "nodes of casting"; equal on all ranks.
        numbers: of the local entities, the owned ones first, shape (entities,).
        owned: how many of them this rank owns.
    """

    name: str
    numbers: LongArray
    owned: int


MOST_AT_NODE = 64
"""More than the pairs, or the rows of pairs, at any node."""


def turn_of(owners: npt.NDArray[Any]) -> LongArray:
    """Return how many entries of the same owner stand before each entry, shape (entries,)."""
    order = np.argsort(owners, kind="stable")
    first = np.searchsorted(owners[order], owners[order])
    turn = np.empty(len(order), dtype=np.int64)
    turn[order] = np.arange(len(order)) - first
    return turn


def numbered_at_nodes(name: str, nodes: LongArray) -> Numbering:
    """Return the numbering of owned entities by their nodes and their turn at them."""
    return Numbering(name, nodes * MOST_AT_NODE + turn_of(nodes), len(nodes))


@dataclass(frozen=True, eq=False)
class Saved:
    """An array of a state.

    Attributes:
        values: rows of the owned entities, those of ghosts may follow; without a numbering an array
            that is equal on all ranks.
        numbering: what the rows belong to; None: the whole run.
    """

    values: Array
    numbering: Numbering | None = None


class Stateful(Protocol):
    """An object that remembers something from step to step."""

    def saved(self) -> dict[str, Saved]:
        """Return the committed state; collective."""

    def restore(self, arrays: Arrays) -> None:
        """Take back a state, committed; collective."""


def joined(parts: Mapping[str, Mapping[str, Saved]]) -> dict[str, Saved]:
    """Return the arrays of several parts under the names "PART/ARRAY"."""
    return {
        f"{part}/{name}": saved for part, arrays in parts.items() for name, saved in arrays.items()
    }


def part_of(arrays: Arrays, part: str) -> dict[str, Array]:
    """Return the arrays of one part under their own names."""
    start = f"{part}/"
    return {name[len(start) :]: array for name, array in arrays.items() if name.startswith(start)}


def saved_parts(parts: Mapping[str, Stateful]) -> dict[str, Saved]:
    """Return the states of several objects; collective."""
    return joined({name: part.saved() for name, part in parts.items()})


def restore_parts(parts: Mapping[str, Stateful], arrays: Arrays) -> None:
    """Restore several objects from what `saved_parts` returned; collective."""
    for name, part in parts.items():
        part.restore(part_of(arrays, name))


def number(value: float) -> Saved:
    """Return a number of the whole run."""
    return Saved(np.array(value))
