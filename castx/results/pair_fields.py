"""Quantities of node pairs as nodal fields of the secondary body."""

from __future__ import annotations

import numpy as np
from dolfinx import fem

from castx.arrays import FloatArray
from castx.results.snapshot import Snapshot


def on_secondary_nodes(snapshot: Snapshot, interface: str, name: str) -> FloatArray:
    """Return a quantity of pairs at the nodes of their secondary body, ghosts included: (nodes,).

    The mean by area where a node has several pairs, zero off the interface; collective.
    """
    pairs = snapshot.pairs[interface]
    field = fem.Function(snapshot.mesh.bodies[pairs.secondary].nodes)
    nodes, areas = pairs.secondary_local, pairs.areas
    shares = areas / np.bincount(nodes, areas)[nodes]
    np.add.at(field.x.array, nodes, shares * snapshot.paired(interface, name))
    field.x.scatter_forward()
    return field.x.array
