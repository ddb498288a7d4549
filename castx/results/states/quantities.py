"""Quantities of results: on nodes, cells or pairs, the names of their parts, pairs on nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import FieldPlace
from castx.case.fields.registry import output_fields, read_from_states

if TYPE_CHECKING:
    from castx.results.states.snapshot import Snapshot

FOLLOWED_IN_CELLS = ("mechanical_strain", "viscoplastic_strain", "coherent")
"""What cells have beside the fields that are written: see `Snapshot.cellwise`."""
PRINCIPAL = ("largest_principal_stress", "smallest_principal_stress")
CELLWISE = read_from_states(FieldPlace.CELL)
MECHANICAL = tuple(name for name, field in output_fields().items() if field.mechanical)
"""What a run without mechanics does not have."""

UNITS = {name: field.unit for name, field in output_fields().items()}
"""Unit of each field in the files."""

PASSING = "passing_time_"
"""Beginning of the names of the fields that `passing_times` stands for."""
MARGINS = "tearing_margin_"
"""Beginning of the names of the fields that `tearing_margin` stands for."""

PAIRED = read_from_states(FieldPlace.PAIR)


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
