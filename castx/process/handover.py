"""What of a saved state belongs to which bodies, when the next stage takes it over."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from castx.stateful import Saved

OF_BODIES = (
    "heat/enthalpy/", "dissipation/", "mechanics/motion/", "mechanics/anchor/", "mechanics/bodies/",
)  # fmt: skip
OF_INTERFACES = ("interfaces/", "mechanics/rows/")
CLOCKS = ("heat/time", "mechanics/time")
"""Times within the cycle."""


def owners(name: str) -> tuple[str, ...]:
    """Return the bodies to which an array of a coupled problem belongs; none: to all together."""
    for start in OF_BODIES:
        if name.startswith(start):
            return (name.removeprefix(start).split("/")[0],)
    for start in OF_INTERFACES:
        parts = name.removeprefix(start).split("/")
        if name.startswith(start) and len(parts) > 2:
            return tuple(parts[:2])
    return ()


def without(state: Mapping[str, Saved], bodies: Collection[str]) -> dict[str, Saved]:
    """Return what of a state belongs neither to some bodies nor to the time in the cycle."""
    return {
        name: saved
        for name, saved in state.items()
        if set(owners(name)).isdisjoint(bodies) and name not in CLOCKS
    }


def left_total(name: str, value: float) -> float:
    """Return a total once its body or interface is gone.

    Amounts keep their last value, forces and powers are zero, and a gap is not a number.
    """
    quantity = name.partition(".")[2].partition(".")[0]
    if quantity in ("mean_gap", "max_gap"):
        return float("nan")
    gone = ("closed_fraction", "force", "power", "ejection_force")
    return 0.0 if quantity in gone or name == "support_force" else value
