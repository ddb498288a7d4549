"""Bodies whose melt flows through the mush, as cases give them, and what is refused."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from castx.case.reading.read import read_case
from castx.coupling.melt_flow import mush_metal, words_of
from castx.errors import CaseError
from castx.materials.lookup import find_material
from tests.coupled_cases import merged, simulation
from tests.verification.mush_strips import skeleton

pytestmark = pytest.mark.sampled

CASE = skeleton({"time": {"end": 1.0}}, elements=2, history=[[0.0, 520.0], [1.0, 510.0]])
RUNNING = {"coefficient": 4e-5, "exponent": 0.25}


def read(data: dict[str, Any]) -> Any:
    return read_case(data, Path("case.toml"))


def without(key: str) -> dict[str, Any]:
    data = deepcopy(CASE)
    del data["materials"]["alloy"][key]
    return data


def test_numbers_reach_the_mechanics():
    numbers = {"arm_spacing": RUNNING, "cavitation": 3e3, "coalescence": 0.95}
    given = {"materials": {"alloy": numbers},
             "foundry": {"feeders": ["casting/top", "casting/far"]}}  # fmt: skip
    case = read(merged(CASE, given))
    metal = mush_metal(case, case.bodies[0], find_material("alloy", case.materials), "mixed")
    assert metal.contraction == pytest.approx(0.06)
    assert metal.coalescence == pytest.approx(0.95)
    assert (metal.viscosity, metal.cavitation, metal.liquidus) == (1e-3, 3e3, 600.0)
    assert (metal.spacing, metal.exponent) == (4e-5, 0.25)
    assert metal.feeders == ("top", "far")
    assert metal.latent == pytest.approx(4e5 / 1000.0)
    assert "40 µm at 1 K/s" in words_of("casting", metal)


def test_defaults():
    case = read(CASE)
    material = find_material("alloy", case.materials)
    metal = mush_metal(case, case.bodies[0], material, "mixed")
    assert (metal.cavitation, metal.feeders) == (1.01e5, None)
    assert metal.coalescence == pytest.approx(0.98)
    other = case.bodies[0].model_copy(update={"feeding": "pockets"})
    assert mush_metal(case, other, material, "mixed") is None


@pytest.mark.parametrize("key", ["melt_viscosity", "arm_spacing", "solidification_shrinkage"])
def test_missing_numbers_are_named(key):
    with pytest.raises(CaseError, match=f"feeding.*needs {key}"):
        read(without(key))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"coupling": {"scheme": "thermal"}}, "only in a body that deforms"),
        ({"materials": {"alloy": {"liquidus": 500.0}}}, "no freezing range"),
    ],
)
def test_where_it_has_no_meaning(changes, says):
    data = merged(CASE, changes)
    if "coupling" in changes:
        data["bodies"][0]["temperature"] = 520.0
        del data["bodies"][0]["temperature_history"]
    with pytest.raises(CaseError, match=says):
        read(data)


def test_quadrilaterals_are_refused(comm):
    data = merged(CASE, {"geometry": {"cells": "quadrilaterals"}})
    with pytest.raises(CaseError, match="triangles or tetrahedra"):
        simulation(comm, data)
