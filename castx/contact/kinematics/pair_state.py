"""State of the pairs of an interface once the bodies are in equilibrium."""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.pair_rows import PairRows
from castx.contact.kinematics.rows import Treatment
from castx.transfer.pair_state import PairState


def contact_state(
    placed: PairRows,
    gap: FloatArray,
    force: FloatArray,
    closed: BoolArray,
    friction: FloatArray | None,
    least: FloatArray | float = 0.0,
) -> PairState:
    """Return the state of an interface.

    Args:
        placed: the pairs and their rows, one for each pair, several where they are tied.
        gap: of the rows [m].
        force: of the rows [N].
        closed: rows that touch.
        friction: on the secondary nodes of the rows [N], shape (rows, dimension); None: there is
            none.
        least: pressure that the rows have whatever their forces, such as that of a liquid [Pa].
    """
    pairs = placed.pairs
    vectors = np.zeros_like(pairs.area_vectors)
    np.add.at(vectors, placed.index, force[:, None] * placed.normals)
    if friction is not None:
        np.add.at(vectors, placed.index, friction)
    areas = placed.areas
    if placed.treatment is Treatment.TIED:
        count = len(pairs.areas)
        gap, closed, areas = np.zeros(count), np.ones(count, dtype=bool), pairs.areas
        force = np.sum(vectors * pairs.normals, axis=1)
    # What a liquid holds may pull. Else it is noise: an equilibrium with a pair that pulls by more
    # is not accepted.
    pushes = np.maximum(force, 0.0)
    pressure = np.divide(pushes, areas, out=np.zeros_like(pushes), where=areas > 0)
    if placed.treatment is not Treatment.TIED:
        pressure = np.maximum(pressure, least)
    return PairState(gap, pressure, closed.copy(), vectors)
