"""Quantities of results: on nodes, cells or pairs, the names of their parts, pairs on nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import FloatArray

if TYPE_CHECKING:
    from castx.results.states.snapshot import Snapshot

FOLLOWED_IN_CELLS = ("mechanical_strain", "coherent")
"""What cells have beside the fields that are written: see `Snapshot.cellwise`."""
PRINCIPAL = ("largest_principal_stress", "smallest_principal_stress")
CELLWISE = ("stress", "von_mises", "plastic_strain", *PRINCIPAL, "point_stress")
CRACKING = (
    "brittle_strain", "brittle_time", "brittle_strain_index", "tearing_margin", "cold_crack_index",
)  # fmt: skip
OF_INTERFACES = ("first_opening",)
OF_DIES = ("strain_range", "life")
MECHANICAL = (
    "displacement", "pressure", "deviation", *CELLWISE, *CRACKING, *OF_INTERFACES, *OF_DIES,
)  # fmt: skip
"""What a run without mechanics does not have."""

UNITS = {
    "temperature": "°C",
    "solid_fraction": "1",
    "enthalpy": "J/m³",
    "displacement": "m",
    "pressure": "Pa",
    "stress": "Pa",
    "von_mises": "Pa",
    "plastic_strain": "1",
    "largest_principal_stress": "Pa",
    "smallest_principal_stress": "Pa",
    "point_stress": "Pa",
    "deviation": "m",
    "gap": "m",
    "contact_pressure": "Pa",
    "heat_transfer_coefficient": "W/m²/K",
    "solidification_time": "s",
    "gradient": "K/m",
    "cooling_rate": "K/s",
    "niyama": "K^½ s^½/m",
    "front_speed": "m/s",
    "passing_times": "s",
    "arm_spacing": "m",
    "dimensionless_niyama": "1",
    "pore_fraction": "1",
    "clyne_davies": "1",
    "yield_strength": "Pa",
    "modulus": "m",
    "pool": "1",
    "brittle_strain": "1",
    "brittle_time": "s",
    "brittle_strain_index": "1",
    "tearing_margin": "1",
    "cold_crack_index": "1",
    "emptied": "1",
    "heat_flux": "W/m²",
    "first_opening": "s",
    "feeding_path": "m",
    "strain_range": "1",
    "life": "1",
}
"""Unit of each field in the files."""

PASSING = "passing_time_"
"""Beginning of the names of the fields that `passing_times` stands for."""
MARGINS = "tearing_margin_"
"""Beginning of the names of the fields that `tearing_margin` stands for."""

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


def on_secondary_nodes(snapshot: Snapshot, interface: str, name: str) -> FloatArray:
    """Return a quantity of pairs at the nodes of their secondary body, ghosts included: (nodes,).

    The mean by area where a node has several pairs, zero off the interface; collective.
    """
    from dolfinx import fem  # names and units are read without it

    pairs = snapshot.pairs[interface]
    field = fem.Function(snapshot.mesh.bodies[pairs.secondary].nodes)
    nodes, areas = pairs.secondary_local, pairs.areas
    shares = areas / np.bincount(nodes, areas)[nodes]
    np.add.at(field.x.array, nodes, shares * snapshot.paired(interface, name))
    field.x.scatter_forward()
    return field.x.array
