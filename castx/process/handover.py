"""Handover from one stage to the next: the saved arrays and totals that go on."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from castx.results.files.column_units import quantity_of
from castx.stateful import Array, Saved


def without(state: Mapping[str, Saved], bodies: Collection[str]) -> dict[str, Saved]:
    """Return the arrays of a state that belong neither to some bodies nor to the cycle that ends.

    Args:
        state: saved arrays by name.
        bodies: names of the bodies that are renewed.
    """
    return {
        name: saved
        for name, saved in state.items()
        if set(saved.owners).isdisjoint(bodies) and not saved.of_cycle
    }


def handed_over(known: Saved, fresh: Saved) -> Array:
    """Return known values for the entities of a new problem, which begin anew where none is known.

    A tied node that leaves a body is free in further directions, and so has further rows beside
    those bodies that it is tied to still.

    Args:
        known: an array of the last problem.
        fresh: the same one of the new problem.
    """
    if known.numbering is None or fresh.numbering is None:
        return known.values
    before = known.numbering.numbers[: len(known.values)]
    now = fresh.numbering.numbers[: len(fresh.values)]
    if np.array_equal(before, now):
        return known.values
    values = fresh.values.copy()
    _, old, new = np.intersect1d(before, now, return_indices=True)
    values[new] = known.values[old]
    return values


def left_total(name: str, value: float) -> float:
    """Return a total of a body or interface that is removed.

    Amounts keep their last value, forces and powers are zero, gaps and temperatures are NaN.

    Args:
        name: column of the total.
        value: its last value.
    """
    quantity = quantity_of(name)
    if quantity.partition("_")[2] in ("gap", "temperature"):
        return float("nan")
    gone = (
        "closed_fraction", "suction", "force", "force_error", "power", "ejection_force",
        "clamp_force", "support_force", "support_moment", "largest_pull",
    )  # fmt: skip
    return 0.0 if quantity in gone else value
