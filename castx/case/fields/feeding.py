"""Pools of liquid and what feeders give."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField, StateView
from castx.input.units import PURE_NUMBER, STRESS

EMPTIED = "emptied"
"""Name of the field of what has flowed out of each node."""


def melt_suction(state: StateView) -> FloatArray:
    """Return the mean stress where some melt is left, not below zero [Pa], shape (nodes,)."""
    suction = np.maximum(state.pressure(), 0.0)
    return np.where(state.heat("solid_fraction") < 1.0, suction, 0.0)


FIELDS = (
    OutputField(
        name="pool",
        title="Pool",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
    ),
    OutputField(
        name="melt_suction",
        title="Suction of the melt",
        unit="Pa",
        place=FieldPlace.NODE,
        read=melt_suction,
        dimension=STRESS,
        mechanical=True,
        shown=FieldColours(
            unit="kPa",
            colours="YlOrRd",
            factor=1e-3,
            caption="Mean stress where some melt is left, zero where all is solid; with flow "
            "through the mush pores open at `cavitation`.",
            melting=True,
            front=True,
            rank=34,
        ),
    ),
    OutputField(
        name="pores",
        title="Pores of the mechanics",
        unit="1",
        place=FieldPlace.CELL,
        read=lambda state: state.pores(),
        dimension=PURE_NUMBER,
        mechanical=True,
        shown=FieldColours(
            unit="%",
            colours="YlOrRd",
            factor=100.0,
            caption="What feeding has left empty: times volume it adds up to `unfed_volume`.",
            melting=True,
            rank=35,
        ),
    ),
    OutputField(
        name=EMPTIED,
        title="Emptied by feeding",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="%",
            colours="Blues",
            factor=100.0,
            caption="The pipe: share that has flowed out.",
            melting=True,
            rank=29,
        ),
    ),
    OutputField(
        name="feeding_path",
        title="Path to the nearest feeder",
        unit="m",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="mm",
            colours="cividis",
            factor=1000.0,
            caption="Inside the casting.",
            melting=True,
            final=True,
            rank=30,
        ),
    ),
)
