"""Stress and plastic strain."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import FieldColours, FieldPlace, OutputField
from castx.foundry.cracking import principal_values
from castx.input.units import PURE_NUMBER, STRESS

STRESS_ERROR = "stress_error"
"""Name of the error of the stress by the mesh."""


def von_mises(stress: FloatArray) -> FloatArray:
    """Return √(3/2)‖s‖ [Pa] of stresses (n, 6) in the order xx, yy, zz, xy, xz, yz."""
    mean = stress[:, :3].mean(axis=1, keepdims=True)
    normal = np.sum((stress[:, :3] - mean) ** 2, axis=1)
    shear = np.sum(stress[:, 3:] ** 2, axis=1)
    return np.asarray(np.sqrt(1.5 * (normal + 2 * shear)))


FIELDS = (
    OutputField(
        name="stress",
        title="Stress",
        unit="Pa",
        place=FieldPlace.CELL,
        read=lambda state: state.stress(),
        dimension=STRESS,
        mechanical=True,
        components=6,
    ),
    OutputField(
        name="von_mises",
        title="Von Mises stress",
        unit="Pa",
        place=FieldPlace.CELL,
        read=lambda state: von_mises(state.stress()),
        dimension=STRESS,
        mechanical=True,
        shown=FieldColours(
            unit="MPa",
            colours="viridis",
            factor=1e-06,
            share=0.99,
            rank=5,
        ),
    ),
    OutputField(
        name="plastic_strain",
        title="Plastic strain",
        unit="1",
        place=FieldPlace.CELL,
        read=lambda state: state.plastic_strain(),
        dimension=PURE_NUMBER,
        mechanical=True,
        shown=FieldColours(
            unit="%",
            colours="viridis",
            factor=100.0,
            share=0.99,
            rank=13,
        ),
    ),
    OutputField(
        name="largest_principal_stress",
        title="Largest principal stress",
        unit="Pa",
        place=FieldPlace.CELL,
        read=lambda state: principal_values(state.stress())[:, 0],
        mechanical=True,
        shown=FieldColours(
            unit="MPa",
            colours="viridis",
            factor=1e-06,
            caption="Positive in tension.",
            share=0.99,
            rank=3,
        ),
    ),
    OutputField(
        name="smallest_principal_stress",
        title="Smallest principal stress",
        unit="Pa",
        place=FieldPlace.CELL,
        read=lambda state: principal_values(state.stress())[:, 2],
        mechanical=True,
        shown=FieldColours(
            unit="MPa",
            colours="viridis",
            factor=1e-06,
            caption="Positive in tension.",
            share=0.99,
            rank=4,
        ),
    ),
    OutputField(
        name=STRESS_ERROR,
        title="Error of the stress by the mesh",
        unit="Pa",
        place=FieldPlace.CELL,
        read=lambda state: state.stress_error(),
        mechanical=True,
        shown=FieldColours(
            unit="MPa",
            colours="viridis",
            factor=1e-06,
            caption="Difference of the stress from a recovered one, in cells that are solid.",
            share=0.99,
        ),
    ),
    OutputField(
        name="point_stress",
        title="Point stress",
        unit="Pa",
        place=FieldPlace.CELL,
        read=lambda state: state.point_stress(),
        mechanical=True,
        components=6,
    ),
    OutputField(
        name="pressure",
        title="Pressure",
        unit="Pa",
        place=FieldPlace.NODE,
        read=lambda state: state.pressure(),
        dimension=STRESS,
        mechanical=True,
        shown=FieldColours(
            unit="MPa",
            colours="viridis",
            factor=1e-06,
            caption="Mean stress, positive in tension.",
            share=0.99,
            rank=6,
        ),
    ),
)
