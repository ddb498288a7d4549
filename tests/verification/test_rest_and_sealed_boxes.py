"""Melt at rest, and boxes that freeze to the end: sealed and rigid, and open on top.

Melt of 2400 kg/m³ rests in a rigid mould, p = -ρ g · depth: -2354.4 Pa at 0.1 m to
1e-8 of it, no displacement.
Metal that does not expand and is a liquid until all is solid (coherency 1) shrinks by s of its
volume V. A box that holds it on all sides ends with pores of s V, an open one has been fed s V, as
solid metal, on any mesh and with any steps. Tolerance 1e-8 V. The metal is tied to the box: one
that it may leave has gaps instead of a part of the pores.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from tests.coupled_cases import merged, states

pytestmark = pytest.mark.sampled

DENSITY, GRAVITY, HEIGHT, SHRINKAGE = 2400.0, 9.81, 0.1, 0.05
VOLUME = {"plane-strain": 0.08 * HEIGHT, "3d": 0.06 * 0.06 * HEIGHT}
ALLOY = {
    "density": DENSITY, "young_modulus": 70e9, "poisson_ratio": 0.33, "expansion": 0.0,
    "heat_capacity": 1000.0, "conductivity": 150.0, "latent_heat": 4e5,
    "solidus": 560.0, "liquidus": 615.0, "solidification_shrinkage": SHRINKAGE,
    "liquid": {"viscosity": 1e6, "coherency": 1.0},
}  # fmt: skip
MOULD = {
    "density": 7800.0, "young_modulus": 210e9, "poisson_ratio": 0.3, "expansion": 0.0,
    "heat_capacity": 460.0, "conductivity": 25.0,
}  # fmt: skip


def box(*changes: dict[str, Any], model: str = "plane-strain") -> dict[str, Any]:
    """Return a box of metal in a rigid mould that it sticks to, cooled evenly within four steps."""
    sides, down = [0.08, HEIGHT], [0.0, -GRAVITY]
    if model == "3d":
        sides, down = [0.06, HEIGHT, 0.06], [0.0, 0.0, -GRAVITY]
    data = {
        "geometry": {
            "generator": "box_in_mould", "model": model, "box": sides, "wall": 0.02, "lid": True,
            "size": 0.02,
        },
        "materials": {"alloy": ALLOY, "steel": MOULD},
        "bodies": [
            {"name": "casting", "material": "alloy",
             "temperature_history": [[0.0, 640.0], [1.0, 500.0]]},
            {"name": "mould", "material": "steel", "temperature": 200.0, "law": "rigid"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": {"method": "tied"}}],
        "loads": {"gravity": down},
        "time": {"end": 1.0, "first_step": 0.25, "largest_step": 0.25},
        "coupling": {"scheme": "mechanical"},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


def chilled(*changes: dict[str, Any]) -> dict[str, Any]:
    """Return a box that freezes from its walls to its middle."""
    data = box({"coupling": {"scheme": "staggered"}}, *changes)
    data["bodies"][0] = {"name": "casting", "material": "alloy", "temperature": 640.0}
    data["interfaces"][0]["heat"] = {"law": "limited", "closed": 3000, "gas_conductivity": 0.05}
    data["time"] = {"end": 200.0, "first_step": 10.0, "largest_step": 10.0}
    return data


def feeding(comm, data) -> dict[str, float]:
    """Return the feeding of the casting at the end, which is all solid."""
    for state in states(comm, data):
        totals = state.totals
    assert totals["casting.solid_fraction"] == pytest.approx(1.0, abs=1e-12)
    return {name: totals[f"casting.{name}"] for name in ("fed_volume", "unfed_volume")}


@pytest.mark.ranks
@pytest.mark.parametrize("lid", [True, False])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
def test_melt_at_rest(comm, lid, model, stabilisation) -> None:
    """On triangles and tetrahedra, in a mould that it only touches."""
    still = {"geometry": {"lid": lid, "size": 0.025}}
    data = box(still, {"solver": {"mechanics_tolerance": 1e-12, "linear": "direct"}}, model=model)
    data["bodies"][0] |= {"stabilisation": stabilisation}
    check_rest(comm, data)


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["3d", "plane-strain"])
@pytest.mark.parametrize("method", ["condensed", "multipliers"])
@pytest.mark.parametrize("lid", [True, False])
def test_melt_of_quadratic_displacements_at_rest(comm, lid, model, method) -> None:
    """Its pressure is linear along the walls, where pairs share it with the mid-sides."""
    still = {"geometry": {"lid": lid, "size": 0.025}}
    data = box(still, {"solver": {"mechanics_tolerance": 1e-12, "linear": "direct"}}, model=model)
    data["bodies"][0] |= {"formulation": "taylor-hood"}
    check_rest(comm, data, method)


def check_rest(comm, data, method="condensed") -> None:
    """Let melt rest in a mould that it touches, and compare its pressure with the exact one."""
    data["bodies"][0] |= {"temperature_history": [[0.0, 640.0], [1.0, 640.0]]}
    data["interfaces"][0]["contact"] = {"method": method}
    for state in states(comm, data):
        if not state.step:
            continue
        points = state.mesh.bodies["casting"].points
        depth = comm.allreduce(float(points[:, -1].max(initial=-1.0)), MPI.MAX) - points[:, -1]
        pressure = state.nodal("casting", "pressure")
        np.testing.assert_allclose(pressure, -DENSITY * GRAVITY * depth, atol=2e-5)
        assert np.abs(state.nodal("casting", "displacement")).max(initial=0.0) < 1e-15
        deepest = comm.allreduce(float(pressure.min(initial=0.0)), MPI.MIN)
        assert deepest == pytest.approx(-2354.4, abs=2e-5)


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("plane-strain", {}),
        ("plane-strain", {"geometry": {"size": 0.01}, "loads": {"gravity": [0.0, 0.0]}}),
        ("plane-strain", {"geometry": {"cells": "quadrilaterals"}, "time": {"first_step": 0.05,
                                                                           "largest_step": 0.05}}),
        ("3d", {}),
    ],
)  # fmt: skip
def test_a_box_that_freezes_everywhere_at_once(comm, model, changes) -> None:
    sealed = feeding(comm, box(changes, model=model))
    assert abs(sealed["unfed_volume"] - SHRINKAGE * VOLUME[model]) < 1e-8 * VOLUME[model]
    assert sealed["fed_volume"] == 0.0
    fed = feeding(comm, box(changes, {"geometry": {"lid": False}}, model=model))
    assert abs(fed["fed_volume"] - SHRINKAGE * VOLUME[model]) < 1e-8 * VOLUME[model]
    assert fed["unfed_volume"] == 0.0


@pytest.mark.parametrize(
    "changes",
    [{}, {"geometry": {"cells": "quadrilaterals", "size": 0.01}, "loads": {"gravity": [0.0, 0.0]}}],
)
def test_a_sealed_box_that_freezes_from_its_walls(comm, changes) -> None:
    found = feeding(comm, chilled(changes))
    volume = VOLUME["plane-strain"]
    assert abs(found["unfed_volume"] - SHRINKAGE * volume) < 1e-8 * volume
    assert found["fed_volume"] == 0.0
