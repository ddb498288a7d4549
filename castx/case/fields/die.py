"""Life of dies."""

from __future__ import annotations

from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField

FIELDS = (
    OutputField(
        name="strain_range",
        title="Strain range of a cycle",
        unit="1",
        place=FieldPlace.CELL,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="%",
            colours="YlOrRd",
            factor=100.0,
            caption="Of the last whole cycle, or so far.",
            beside="YlOrRd",
            final=True,
            share=0.99,
            rank=31,
        ),
    ),
    OutputField(
        name="life",
        title="Cycles to a crack (pictures: log10)",
        unit="1",
        place=FieldPlace.CELL,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="",
            colours="RdYlGn",
            caption=(
                "log10 of the number of cycles: 4 is 10,000. Isothermal "
                "coefficients, without oxidation and soldering."
            ),
            beside="RdYlGn",
            final=True,
            share=0.9,
            rank=32,
        ),
    ),
)
