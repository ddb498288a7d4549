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
    felt: FloatArray | None = None,
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
        felt: forces of the rows as liquid at the wall feels them [N]; None: as they are.
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
    pressure = _stress(force, areas)
    pulls = force if felt is None or placed.treatment is Treatment.TIED else felt
    suction = np.where(closed, _stress(-pulls, areas), 0.0)
    if placed.treatment is not Treatment.TIED:
        pressure = np.maximum(pressure, least)
    return PairState(gap, pressure, closed.copy(), vectors, suction)


def _stress(force: FloatArray, areas: FloatArray) -> FloatArray:
    """Return positive forces over areas [Pa], zero elsewhere."""
    positive = np.maximum(force, 0.0)
    found = np.divide(positive, areas, out=np.zeros_like(positive), where=areas > 0)
    return np.asarray(found)
