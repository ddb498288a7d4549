"""Where the quantities of results live, and how their parts are called."""

from __future__ import annotations

CELLWISE = ("stress", "von_mises", "plastic_strain")
MECHANICAL = ("displacement", "pressure", *CELLWISE)
"""What a run without mechanics does not have."""

PAIRED = ("gap", "contact_pressure", "heat_transfer_coefficient")


def parts(quantity: str, model: str) -> tuple[str, ...]:
    """Return the names of the parts of a vector or tensor; none for a scalar.

    The parts of the stress are those of the arrays (cells, 6), in their order.
    """
    axisymmetric = model == "axisymmetric"
    match quantity:
        case "displacement":
            return ("r", "z") if axisymmetric else ("x", "y", "z") if model == "3d" else ("x", "y")
        case "stress":
            planes = ("rr", "zz", "tt", "rz") if axisymmetric else ("xx", "yy", "zz", "xy")
            return (*planes, "xz", "yz") if model == "3d" else planes
        case _:
            return ()
