"""Quantities of a place that follow from how it froze."""

from __future__ import annotations

from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField

FIELDS = (
    OutputField(
        name="solidification_time",
        title="Local solidification time",
        unit="s",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="s",
            colours="cividis",
            caption="Time between liquidus and solidus.",
            melting=True,
            final=True,
            rank=14,
        ),
    ),
    OutputField(
        name="gradient",
        title="Temperature gradient",
        unit="K/m",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="K/mm",
            colours="viridis",
            factor=0.001,
            caption="At {front}.",
            melting=True,
            final=True,
            share=0.9,
            rank=25,
        ),
    ),
    OutputField(
        name="cooling_rate",
        title="Cooling rate",
        unit="K/s",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="K/s",
            colours="viridis",
            caption="At {front}.",
            melting=True,
            final=True,
            share=0.9,
            rank=26,
        ),
    ),
    OutputField(
        name="niyama",
        title="Niyama criterion",
        unit="K^½ s^½/m",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="K^½ s^½/mm",
            colours="RdYlGn",
            factor=0.001,
            caption=(
                "G/√Ṫ at {front}. Shrinkage porosity is likely where it is low; the "
                "limit depends on the alloy, for steel castings it is near 1 K^½ "
                "s^½/mm."
            ),
            melting=True,
            final=True,
            share=0.9,
            rank=15,
        ),
    ),
    OutputField(
        name="front_speed",
        title="Speed of the front",
        unit="m/s",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="mm/s",
            colours="viridis",
            factor=1000.0,
            caption="At {front}.",
            melting=True,
            final=True,
            share=0.9,
            rank=24,
        ),
    ),
    OutputField(
        name="passing_times",
        title="Passing times",
        unit="s",
        place=FieldPlace.NODE,
        followed=True,
    ),
    OutputField(
        name="arm_spacing",
        title="Secondary arm spacing",
        unit="m",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="µm",
            colours="viridis",
            factor=1000000.0,
            caption="From the cooling rate at {front}.",
            melting=True,
            final=True,
            rank=27,
        ),
    ),
    OutputField(
        name="dimensionless_niyama",
        title="Dimensionless Niyama criterion",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="",
            colours="RdYlGn",
            caption="λ2 G √(Δp_c/(μ β ΔT_f Ṫ)) at {front}. Pores open where it is low.",
            melting=True,
            final=True,
            share=0.9,
            rank=16,
        ),
    ),
    OutputField(
        name="pore_fraction",
        title="Shrinkage porosity",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="%",
            colours="YlOrRd",
            factor=100.0,
            caption=(
                "Pores where the suction of the mush reaches its limit, from the "
                "history at {front}: arm spacing, viscosity and the limit are "
                "uncertain by tens of percent, gas is left out, and so is feeding "
                "over a distance."
            ),
            melting=True,
            final=True,
            share=0.99,
            rank=17,
        ),
    ),
    OutputField(
        name="yield_strength",
        title="Yield strength by arm spacing",
        unit="Pa",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="MPa",
            colours="viridis",
            factor=1e-06,
            caption="A regression, valid for the heat treatment of its samples alone.",
            melting=True,
            final=True,
            rank=28,
        ),
    ),
    OutputField(
        name="modulus",
        title="Thermal modulus",
        unit="m",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="mm",
            colours="cividis",
            factor=1000.0,
            caption=(
                "√(t_s/C) of the time from pouring until all is solid; C holds for "
                "sand, not for dies."
            ),
            melting=True,
            final=True,
            rank=23,
        ),
    ),
)
