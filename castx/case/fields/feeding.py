"""Pools of liquid and what feeders give."""

from __future__ import annotations

from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField

FIELDS = (
    OutputField(
        name="pool",
        title="Pool",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
    ),
    OutputField(
        name="emptied",
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
