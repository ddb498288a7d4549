"""Handover from one stage to the next: the saved arrays and totals that go on."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from castx.stateful import Saved


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


def left_total(name: str, value: float) -> float:
    """Return a total of a body or interface that is removed.

    Amounts keep their last value, forces and powers are zero, gaps and temperatures are NaN.

    Args:
        name: column of the total.
        value: its last value.
    """
    quantity = name.partition(".")[2].partition(".")[0]
    if quantity.partition("_")[2] in ("gap", "temperature"):
        return float("nan")
    gone = (
        "closed_fraction", "suction", "force", "force_error", "power", "ejection_force",
        "clamp_force",
    )  # fmt: skip
    return 0.0 if quantity in gone or name in ("support_force", "largest_pull") else value
