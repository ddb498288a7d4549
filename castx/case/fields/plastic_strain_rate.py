"""Rate of the plastic strain."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField, StateView
from castx.input.units import Dimension


def plastic_strain_rate(state: StateView) -> FloatArray:
    """Return Δε_p/Δt of the last accepted step [1/s], shape (cells,).

    Δε_p is the increment of the equivalent plastic strain: zero before the first step and, until
    the next one, in a state restored from a checkpoint.
    """
    return np.asarray(state.plastic_strain_increment() / state.step_size)


FIELDS = (
    OutputField(
        name="plastic_strain_rate",
        title="Plastic strain rate",
        unit="1/s",
        place=FieldPlace.CELL,
        read=plastic_strain_rate,
        dimension=Dimension("a strain rate", "1/s"),
        mechanical=True,
        shown=FieldColours(
            unit="1/s",
            colours="viridis",
            caption="Mean over the last step.",
            share=0.99,
            rank=13,
        ),
    ),
)
