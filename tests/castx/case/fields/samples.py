"""A state whose arrays are known, and numbers of fields as the report shows them."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import OutputField

PAIRS, NODES, CELLS = 4, 5, 3


class KnownState:
    """Arrays of numbers drawn with a seed; `StateView` for fields that are read from it."""

    def __init__(self, step_size: float = 0.5) -> None:
        draw = np.random.default_rng(7).normal
        self.step_size = step_size
        self.nodes: dict[str, FloatArray] = {
            "temperature": draw(size=NODES),
            "enthalpy": draw(size=NODES),
            "solid_fraction": np.array([0.0, 0.2, 0.5, 0.9, 1.0]),
        }
        self.moved, self.mean_stress = draw(size=(NODES, 2)), draw(size=NODES)
        self.tensors = 1e6 * draw(size=(CELLS, 6))
        self.point_tensors = 1e6 * draw(size=(CELLS, 24))
        self.plastic, self.increment = np.abs(draw(size=(2, CELLS)))
        self.gaps, self.pressures = np.abs(draw(size=(2, PAIRS)))
        self.voids = np.array([0.0, 0.02, 0.05])
        self.pulls = np.array([0.0, 2e3, 0.0, 5e4])
        self.resistances = np.array([1e-3, 2e-3, 5e-4, 0.0])

    def heat(self, name: str, /) -> FloatArray:
        return self.nodes[name]

    def displacement(self) -> FloatArray:
        return self.moved

    def pressure(self) -> FloatArray:
        return self.mean_stress

    def stress(self) -> FloatArray:
        return self.tensors

    def point_stress(self) -> FloatArray:
        return self.point_tensors

    def plastic_strain(self) -> FloatArray:
        return self.plastic

    def plastic_strain_increment(self) -> FloatArray:
        return self.increment

    def pores(self) -> FloatArray:
        return self.voids

    def gap(self) -> FloatArray:
        return self.gaps

    def contact_pressure(self) -> FloatArray:
        return self.pressures

    def wall_suction(self) -> FloatArray:
        return self.pulls

    def resistance(self) -> FloatArray:
        return self.resistances


def by_name(fields: tuple[OutputField, ...]) -> dict[str, OutputField]:
    """Return fields by name."""
    return {field.name: field for field in fields}


def followed(fields: tuple[OutputField, ...]) -> dict[str, str]:
    """Return the places of those fields that are followed from step to step."""
    return {field.name: field.place.value for field in fields if field.place and field.followed}


def displayed(field: OutputField, value: float) -> str:
    """Return a value of the files [SI] with its unit, as the report shows it."""
    assert field.shown is not None
    return f"{value * field.shown.factor:.6g} {field.shown.unit}".rstrip()
