"""What is left in a plate that has frozen and cooled through, beside layers in one dimension.

The reference is in `freezing_layers.py`: layers that are solid or not, each with a past of its own.
In castx solid grows inside 20 cells. Nothing bends, no force acts along the plate.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.proof.verification.solids.freezing_plate import (
    EXPANSION,
    LENGTH,
    MELTING,
    SPAN,
    Plate,
    contraction,
    plate_case,
)
from castx.proof.verification.states import cell_volumes, cellwise, centres
from tests.coupled_cases import merged, simulation
from tests.verification.freezing_layers import SECONDS, Layers, Metal

pytestmark = [pytest.mark.serial, pytest.mark.sampled]

CELLS, COLD, HOT = 20, 20e6, 1e6
METALS = {
    "plastic": Metal(COLD, HOT, hardening=5e8),
    "viscoplastic": Metal(COLD, HOT, viscosity=2e10),
    "kinematic": Metal(COLD, HOT, kinematic=2e9),
}
MESHES = {
    "triangles": ("generalised-plane-strain", "simplices"),
    "quadrilaterals": ("generalised-plane-strain", "quadrilaterals"),
    "tetrahedra": ("3d", "simplices"),
}
PLATE = Plate(1.0, 4.0, 400)
"""All of it is frozen at a quarter of the time, and nine tenths cooled at the end."""
STEPS = {"solid_fraction_change": 0.01, "temperature_change": 5.0}
"""A quarter of the default ones, in which stresses are up to 3 % of the strength off."""
HEATED, HALF_MOLTEN, ALL_MOLTEN = 0.5, 0.7, 1.0
"""Times from which on a plate is heated, and from which on it is cooled again."""


class Run(NamedTuple):
    """Lateral strain over time; lateral stresses and flow of the layers of cells at the end."""

    strain: FloatArray
    stress: FloatArray
    across: FloatArray
    flow: FloatArray


def run(comm, data: dict[str, Any]) -> Run:
    """Run a case of the plate; linear triangles zigzag within a layer of cells."""
    last: list[Any] = []

    def states():
        for state in simulation(comm, data):
            assert state.counters.cutbacks == 0
            last[:] = [state]
            yield state

    strain = contraction(states(), data)
    cells = round(LENGTH / data["geometry"]["size"])
    layer = (centres(last[0], "casting")[:, 0] / LENGTH * cells).astype(int)
    volumes = cell_volumes(last[0], "casting")

    def means(values: FloatArray) -> FloatArray:
        return np.bincount(layer, volumes * values) / np.bincount(layer, volumes)

    stress = cellwise(last[0], "casting", "stress")
    lateral = np.array([means(stress[:, 1]), means(stress[:, 2])])
    flow = means(cellwise(last[0], "casting", "plastic_strain"))
    return Run(strain, lateral, means(stress[:, 0]), flow)


def layer_means(values: FloatArray, cells: int) -> FloatArray:
    """Return means of nodal values of a finer grid over layers of cells, (cells,)."""
    places = np.linspace(0.0, 1.0, len(values))
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))]) / (len(values) - 1)
    return np.diff(np.interp(np.linspace(0.0, 1.0, cells + 1), places, sums)) * cells


def flowing(data: dict[str, Any], metal: Metal) -> dict[str, Any]:
    """Return the case with a metal that flows."""
    properties: dict[str, Any] = {
        "yield_stress": [[MELTING - SPAN, metal.cold], [MELTING, metal.hot]],
        "hardening": {"linear": metal.hardening},
        "kinematic_hardening": metal.kinematic,
        "dissipation": 0.0,
    }
    law = "thermo-elasto-plastic"
    if metal.viscosity:
        properties["viscosity"], law = metal.viscosity, "thermo-elasto-viscoplastic"
    made = merged(data, {"materials": {"metal": properties}})
    made["bodies"][0]["law"] = law
    return made


@cache
def layers(metal: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what the layers of the plate give for a metal."""
    return Layers(PLATE, METALS[metal]).stress()


@pytest.mark.parametrize(
    "metal, mesh",
    [
        *(("plastic", mesh) for mesh in MESHES),
        ("viscoplastic", "quadrilaterals"),
        ("kinematic", "tetrahedra"),
    ],
)
def test_stress_and_flow_of_a_plate_that_has_frozen(comm, metal, mesh):
    strain, stress, flow = layers(metal)
    data = flowing(plate_case(PLATE, *MESHES[mesh], CELLS), METALS[metal])
    data["time"] = {"end": data["time"]["end"], **STEPS}
    found = run(comm, data)
    assert np.abs(stress).max() > 0.9 * COLD
    assert np.abs(found.stress - layer_means(stress, CELLS)).max() < 0.02 * COLD
    assert np.abs(found.across).max() < 1e-6 * COLD
    assert found.strain[-1] * EXPANSION * SPAN == pytest.approx(strain[-1], rel=0.03)
    assert np.abs(found.flow - layer_means(flow, CELLS)).max() < 0.1 * flow.max()


REMELTED = Plate(1.0, 4.5, 225)


def ambient(time: float, cooled: float) -> float:
    """Return what cools the plate, or heats it for a while, over time."""
    return 1.5 if HEATED < time < cooled else -1.0


@cache
def remelted_layers(cooled: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what the layers of a plate give that is heated for a while."""
    outside, plate = partial(ambient, cooled=cooled), replace(REMELTED, steps=900)
    return Layers(plate, METALS["plastic"], outside, cells=240).stress()


@pytest.mark.parametrize(
    "mesh, cooled",
    [*((mesh, ALL_MOLTEN) for mesh in MESHES), ("triangles", HALF_MOLTEN)],
)
def test_what_melts_forgets_what_it_has_borne(comm, mesh, cooled):
    """Frozen to its half, the plate melts from its wall, in whole or in part, and freezes again.

    In the cells where the front turns old and new solid are one, so that errors there are larger.
    """
    strain, stress, _ = remelted_layers(cooled)
    cold, hot, moment = MELTING - SPAN, MELTING + 1.5 * SPAN, 1e-9
    times = [0.0, HEATED, HEATED + moment, cooled, cooled + moment, REMELTED.end]
    ambients = [cold, cold, hot, hot, cold, cold]
    table = [[time * SECONDS, value] for time, value in zip(times, ambients, strict=True)]
    data = flowing(plate_case(REMELTED, *MESHES[mesh], CELLS), METALS["plastic"])
    data["boundaries"][0]["heat"]["ambient"] = table
    found = run(comm, data)
    error = found.stress - layer_means(stress, CELLS)
    assert np.sqrt(np.mean(error**2, axis=1)).max() < 0.02 * COLD
    if cooled == ALL_MOLTEN:
        assert np.abs(error).max() < 0.02 * COLD
    assert found.strain[-1] * EXPANSION * SPAN == pytest.approx(strain[-1], rel=0.03)


def test_a_plate_in_plane_stress_contracts_as_it_freezes(comm):
    """Uniaxial stress: nothing holds the plate in its other lateral direction."""
    plate = Plate(1.0, 4.0, 200)
    strain, stress, _ = Layers(replace(plate, steps=1600), plane_stress=True).stress()
    strain = strain[::8]
    found = run(comm, plate_case(plate, "plane-stress", "simplices", 16))
    half = plate.steps // 8
    for index in (half, -1):
        assert found.strain[index] * EXPANSION * SPAN == pytest.approx(strain[index], rel=0.05)
    error = found.stress[0] - layer_means(stress, 16)
    assert np.sqrt(np.mean(error**2)) < 0.03 * np.sqrt(np.mean(stress**2))
    assert np.abs(found.stress[1]).max() < 1e-6 * np.abs(stress).max()
