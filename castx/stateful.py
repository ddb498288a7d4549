"""State of an object as named arrays, for checkpoints and for the next stage.

`saved()` returns the state at the end of the last accepted step, `restore(arrays)` takes it back
from arrays of the same names, whose rows are then the local entities with their ghosts. Rows are
numbered as in the mesh before it was distributed, so that the number of ranks may change.
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
        bodies: names of the bodies to which they belong, two for pairs.
    """

    name: str
    numbers: LongArray
    owned: int
    bodies: tuple[str, ...]


MOST_AT_NODE = 64
"""Upper bound of the pairs, or of the rows of pairs, at any node."""


def occurrence(values: npt.NDArray[Any]) -> LongArray:
    """Return the number of equal values before each value, shape (values,)."""
    order = np.argsort(values, kind="stable")
    first = np.searchsorted(values[order], values[order])
    count = np.empty(len(order), dtype=np.int64)
    count[order] = np.arange(len(order)) - first
    return count


def numbered_at_nodes(name: str, nodes: LongArray, bodies: tuple[str, ...]) -> Numbering:
    """Return a numbering of owned entities of which several may stand at one node.

    Args:
        name: of the kind of entity.
        nodes: number of the node of each entity, fewer than `MOST_AT_NODE` at one, (entities,).
        bodies: names of the bodies to which the entities belong.
    """
    return Numbering(name, nodes * MOST_AT_NODE + occurrence(nodes), len(nodes), bodies)


@dataclass(frozen=True, eq=False)
class Saved:
    """An array of a saved state.

    Attributes:
        values: rows of the owned entities, rows of ghosts may follow; without a numbering an array
            that is equal on all ranks.
        numbering: entities of the rows; None: the array has none.
        bodies: names of the bodies to which an array without entities belongs; none: it belongs to
            the whole run.
        of_cycle: whether it starts anew with every cycle, as the time within it does.
    """

    values: Array
    numbering: Numbering | None = None
    bodies: tuple[str, ...] = ()
    of_cycle: bool = False

    @property
    def owners(self) -> tuple[str, ...]:
        """Names of the bodies to which the array belongs; none: the whole run."""
        return self.bodies if self.numbering is None else self.numbering.bodies


class Stateful(Protocol):
    """An object with a state that lasts from step to step."""

    def saved(self) -> dict[str, Saved]:
        """Return the state of the last accepted step; collective."""

    def restore(self, arrays: Arrays) -> None:
        """Set the state of the last accepted step; collective."""


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
    """Restore several objects from arrays named as by `saved_parts`; collective."""
    for name, part in parts.items():
        part.restore(part_of(arrays, name))


def number(value: float, *, bodies: tuple[str, ...] = (), of_cycle: bool = False) -> Saved:
    """Return a saved number; the other arguments are the attributes of `Saved`."""
    return Saved(np.array(value), bodies=bodies, of_cycle=of_cycle)
