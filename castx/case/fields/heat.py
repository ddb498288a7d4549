"""Temperature and what hangs on it."""

from __future__ import annotations

from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField
from castx.input.units import PURE_NUMBER, TEMPERATURE, Dimension

ENTHALPY = Dimension("an enthalpy per volume", "J/m^3", ("J/m^3", "MJ/m^3"))
FLUX_ERROR = "heat_flux_error"
"""Name of the error of the heat flux by the mesh."""

FIELDS = (
    OutputField(
        name="temperature",
        title="Temperature",
        unit="°C",
        place=FieldPlace.NODE,
        read=lambda state: state.heat("temperature"),
        dimension=TEMPERATURE,
        shown=FieldColours(
            unit="°C",
            colours="inferno",
            caption="The blue line is f_s = 0.5.",
            beside="viridis",
            front=True,
            rank=1,
        ),
    ),
    OutputField(
        name="solid_fraction",
        title="Solid fraction",
        unit="1",
        place=FieldPlace.NODE,
        read=lambda state: state.heat("solid_fraction"),
        dimension=PURE_NUMBER,
        shown=FieldColours(
            unit="",
            colours="Blues",
            melting=True,
            front=True,
            rank=2,
        ),
    ),
    OutputField(
        name="enthalpy",
        title="Enthalpy",
        unit="J/m³",
        place=FieldPlace.NODE,
        read=lambda state: state.heat("enthalpy"),
        dimension=ENTHALPY,
    ),
    OutputField(
        name="heat_flux",
        title="Heat flux",
        unit="W/m²",
        place=FieldPlace.CELL,
        followed=True,
        shown=FieldColours(
            unit="kW/m²",
            colours="inferno",
            factor=0.001,
            caption="Size of -k ∇T; the files of the fields have its direction.",
            beside="viridis",
            share=0.99,
            rank=9,
        ),
    ),
    OutputField(
        name=FLUX_ERROR,
        title="Error of the heat flux by the mesh",
        unit="W/m²",
        place=FieldPlace.CELL,
        followed=True,
        shown=FieldColours(
            unit="kW/m²",
            colours="viridis",
            factor=0.001,
            caption="Root mean square over the time so far, estimated by a recovered heat flux.",
            share=0.99,
        ),
    ),
)
