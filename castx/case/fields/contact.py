"""Gaps, pressure and heat of interfaces."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField, StateView
from castx.input.units import HEAT_TRANSFER, LENGTH, STRESS


def heat_transfer_coefficient(state: StateView) -> FloatArray:
    """Return 1/R of the pairs [W/m²/K], shape (pairs,)."""
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / state.resistance())


FIELDS = (
    OutputField(
        name="gap",
        title="Gap",
        unit="m",
        place=FieldPlace.PAIR,
        read=lambda state: state.gap(),
        dimension=LENGTH,
        shown=FieldColours(
            unit="µm",
            colours="YlGnBu",
            factor=1000000.0,
            caption="On the surface of the casting.",
            melting=True,
            rank=10,
        ),
    ),
    OutputField(
        name="contact_pressure",
        title="Contact pressure",
        unit="Pa",
        place=FieldPlace.PAIR,
        read=lambda state: state.contact_pressure(),
        dimension=STRESS,
        shown=FieldColours(
            unit="MPa",
            colours="YlOrRd",
            factor=1e-06,
            caption="On the surface of the casting. Liquid presses at least by its depth; where a "
            "wall pulls it, which is no pressure, `wall_suction` has the pull.",
            melting=True,
            share=0.99,
            rank=11,
        ),
    ),
    OutputField(
        name="wall_suction",
        title="Suction at the wall",
        unit="Pa",
        place=FieldPlace.PAIR,
        read=lambda state: state.wall_suction(),
        dimension=STRESS,
        shown=FieldColours(
            unit="kPa",
            colours="YlOrRd",
            factor=1e-3,
            caption="On the surface of the casting: by how much a wall pulls metal that is not "
            "solid yet.",
            melting=True,
            rank=33,
        ),
    ),
    OutputField(
        name="heat_transfer_coefficient",
        title="Heat transfer coefficient",
        unit="W/m²/K",
        place=FieldPlace.PAIR,
        read=heat_transfer_coefficient,
        dimension=HEAT_TRANSFER,
        shown=FieldColours(
            unit="W/m²/K",
            colours="YlOrRd",
            caption="On the surface of the casting.",
            melting=True,
            rank=12,
        ),
    ),
    OutputField(
        name="first_opening",
        title="First opening of the gap",
        unit="s",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="s",
            colours="cividis",
            caption="On the surface of the casting, in plane pictures one cell wide.",
            melting=True,
            final=True,
            rank=8,
        ),
    ),
)
