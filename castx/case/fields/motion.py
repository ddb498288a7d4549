"""Displacement and deviation."""

from __future__ import annotations

from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField
from castx.input.units import LENGTH

DEVIATION = "deviation"
"""Name of the field of distances from the nominal surface."""

FIELDS = (
    OutputField(
        name="displacement",
        title="Displacement",
        unit="m",
        place=FieldPlace.NODE,
        read=lambda state: state.displacement(),
        dimension=LENGTH,
        mechanical=True,
    ),
    OutputField(
        name=DEVIATION,
        title="Deviation from the nominal surface",
        unit="m",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="mm",
            colours="RdBu_r",
            factor=1000.0,
            caption=(
                "After the best-fit motion; positive outward. In plane pictures one cell wide."
            ),
            rank=7,
        ),
    ),
)
