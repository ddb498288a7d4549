"""Pools of liquid and what feeders give."""

from __future__ import annotations

from castx.case.fields.declaration import OutputField, Place, Shown

FIELDS = (
    OutputField(
        name="pool",
        title="Pool",
        unit="1",
        place=Place.NODE,
        followed=True,
    ),
    OutputField(
        name="emptied",
        title="Emptied by feeding",
        unit="1",
        place=Place.NODE,
        followed=True,
        shown=Shown(
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
        place=Place.NODE,
        followed=True,
        shown=Shown(
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
