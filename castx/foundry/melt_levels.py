"""Levels of feeders that communicate through liquid."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray


def communicating(areas: FloatArray, levels: FloatArray, demand: float) -> tuple[float, FloatArray]:
    """Return the level of feeders after a demand, z = (Σ A_k z_k - V)/Σ A_k, and what each gives.

    Feeders whose level rises give less than nothing. None may run dry: the level is that of
    prisms.

    Args:
        areas: A_k of the free surfaces [m²], (feeders,).
        levels: z_k before [m].
        demand: V, the volume that the casting takes [m³].

    Returns:
        Level [m], volumes that sum to the demand [m³].
    """
    areas, levels = np.asarray(areas, dtype=np.float64), np.asarray(levels, dtype=np.float64)
    level = float((areas @ levels - demand) / areas.sum())
    return level, np.asarray(areas * (levels - level))
