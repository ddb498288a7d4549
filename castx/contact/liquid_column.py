"""Pressure of a liquid at rest: that of its column below the highest point of the same liquid."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.liquid.regions import CellRegions


def column_pressure(regions: CellRegions, liquid: BoolArray, head: FloatArray) -> FloatArray:
    """Return p = x·b - min x·b over the liquid that a node is connected to; collective.

    Cells with a common node are connected.

    Args:
        regions: of the cells of the body.
        liquid: liquid cells of this rank, ghosts included, shape (cells,).
        head: x·b at the local nodes with the body force b [Pa], shape (nodes,).

    Returns:
        At the local nodes [Pa], shape (nodes,); zero where no liquid cell is on this rank.
    """
    count, region = regions.find(liquid)
    corners = regions.cell_nodes[liquid]
    columns = np.repeat(region[liquid], corners.shape[1])
    highest = np.full(count, np.inf)
    np.minimum.at(highest, columns, head[corners.ravel()])
    regions.comm.Allreduce(MPI.IN_PLACE, highest, op=MPI.MIN)
    pressure = np.zeros(len(head))
    pressure[corners.ravel()] = head[corners.ravel()] - highest[columns]
    return pressure
