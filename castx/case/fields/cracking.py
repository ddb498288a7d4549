"""Hot tearing and cold cracks."""

from __future__ import annotations

from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField

FIELDS = (
    OutputField(
        name="clyne_davies",
        title="Hot-tearing ratio of Clyne and Davies",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        shown=FieldColours(
            unit="",
            colours="YlOrRd",
            caption=(
                "Time from f_s = 0.9 to 0.99 over that from 0.4 to 0.9: it compares "
                "places, without a limit, and has no stress in it."
            ),
            melting=True,
            final=True,
            share=0.9,
            rank=18,
        ),
    ),
    OutputField(
        name="brittle_strain",
        title="Strain in the brittle range",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="%",
            colours="YlOrRd",
            factor=100.0,
            caption=(
                "Largest principal strain across the gradient, elastic and "
                "inelastic, gained from f_s = 0.9 to 0.99: what the alloy bears is "
                "another matter."
            ),
            melting=True,
            final=True,
            share=0.99,
            rank=19,
        ),
    ),
    OutputField(
        name="brittle_time",
        title="Time in the brittle range",
        unit="s",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="s",
            colours="cividis",
            caption="From f_s = 0.9 to 0.99.",
            melting=True,
            final=True,
            share=0.99,
            rank=21,
        ),
    ),
    OutputField(
        name="brittle_strain_index",
        title="Strain in the brittle range over what the alloy bears",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="",
            colours="YlOrRd",
            caption=(
                "Strain gained from f_s = 0.9 to 0.99 over critical_strain; above 1 "
                "it tears."
            ),
            melting=True,
            final=True,
            share=0.99,
            rank=20,
        ),
    ),
    OutputField(
        name="tearing_margin",
        title="Tearing margin",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
    ),
    OutputField(
        name="suction_margin",
        title="Suction margin",
        unit="1",
        place=FieldPlace.NODE,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="",
            colours="YlOrRd",
            caption=(
                "Largest suction of the mush until its dendrites have grown together, over the "
                "depression at which films of melt tear; above 1 they do."
            ),
            melting=True,
            final=True,
            share=0.99,
            rank=36,
        ),
    ),
    OutputField(
        name="cold_crack_index",
        title="Cold-crack index",
        unit="1",
        place=FieldPlace.CELL,
        followed=True,
        mechanical=True,
        shown=FieldColours(
            unit="",
            colours="YlOrRd",
            caption="Largest σ_1/R_m(T) since the metal was solid; above 1 it cracks.",
            final=True,
            share=0.99,
            rank=22,
        ),
    ),
)
