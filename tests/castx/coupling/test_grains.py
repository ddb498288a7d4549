"""A core of sand in a run: its keys reach it, it is restarted, refused by name, on all ranks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.case.bodies import Body
from castx.coupling.building import formulation_of
from castx.errors import CaseError
from tests import coupled_cases
from tests.castx.coupling.test_building import changed
from tests.castx.mechanics.lone_bodies import slab_mesh
from tests.coupled_cases import final_state, ring

SAND = {
    "density": 1600.0, "heat_capacity": 1000.0, "conductivity": 0.7, "young_modulus": 5e8,
    "poisson_ratio": 0.25, "expansion": 2e-5,
    "granular": {
        "cohesion": [[20.0, 2e5], [500.0, 1e4]], "friction_angle": 30.0, "dilatancy_angle": 5.0,
        "tension_cut_off": [[20.0, 1e5], [500.0, 3e3]], "relaxation_time": 1.0,
    },
}  # fmt: skip
CHANGES: list[tuple[str, Any]] = [
    ("bodies.1.law", "thermo-elastic"),
    ("materials.sand.granular.cohesion", 3e5),
    ("materials.sand.granular.friction_angle", "25 deg"),
    ("materials.sand.granular.dilatancy_angle", 0.0),
    ("materials.sand.granular.relaxation_time", "3 s"),
]


def sand_core() -> dict[str, Any]:
    """Return a solid ring that cools on a core of sand, which its heat expands and burns."""
    data = ring({"time": {"end": 60.0, "fixed_step": 20.0}, "materials": {"sand": SAND}}, size=5e-3)
    data["bodies"][0] |= {"temperature": 600.0}
    data["bodies"][1] |= {"material": "sand", "law": "drucker-prager", "temperature": 20.0}
    return data


def answer(comm, data: dict[str, Any]) -> np.ndarray:
    state = final_state(comm, data)
    return np.abs(state.cellwise("core", "stress")).sum(axis=0)


@pytest.fixture(scope="module")
def known() -> dict[str, np.ndarray]:
    return {}


@pytest.mark.serial
@pytest.mark.parametrize(("path", "value"), CHANGES)
def test_each_key_changes_the_answer(comm, known, path, value) -> None:
    if not known:
        known["stress"] = answer(comm, sand_core())
    found = answer(comm, changed(sand_core(), path, value))
    assert np.abs(found - known["stress"]).max() > 1e-3 * known["stress"].max()


@pytest.mark.serial
def test_the_cut_off_acts_where_a_skin_of_sand_cools(comm) -> None:
    """A cold ring round hot sand, whose skin is torn."""
    data = changed(changed(sand_core(), "bodies.0.temperature", 20.0), "bodies.1.temperature", 400)
    lower = changed(data, "materials.sand.granular.tension_cut_off", 1e3)
    found = [answer(comm, each) for each in (data, lower)]
    assert np.abs(found[1] - found[0]).max() > 1e-3 * found[0].max()


@pytest.mark.ranks
def test_sand_flows_where_it_is_hot(comm) -> None:
    state = final_state(comm, sand_core())
    flowed = comm.allreduce(state.cellwise("core", "plastic_strain").max(initial=0.0), op=max)
    assert 1e-3 < flowed < 0.1


@pytest.mark.serial
def test_a_formulation_that_grains_do_not_have_is_refused(comm) -> None:
    data = changed(sand_core(), "bodies.1.formulation", "mixed")
    with pytest.raises(CaseError, match=r"'core' has formulation 'mixed'.*have 'displacement'"):
        coupled_cases.simulation(comm, data)


@pytest.mark.serial
def test_plane_stress_of_grains_is_refused(comm) -> None:
    sand = Body(name="casting", material="sand-silica", temperature=20.0, law="drucker-prager")
    with pytest.raises(CaseError, match="'casting': the law 'drucker-prager' has no plane stress"):
        formulation_of(slab_mesh(comm, "plane-stress"), sand)
    assert formulation_of(slab_mesh(comm, "plane-strain"), sand) == "displacement"


@pytest.mark.serial
def test_a_material_without_its_data_is_refused_by_name(comm) -> None:
    data = sand_core()
    del data["materials"]["sand"]["granular"]
    with pytest.raises(CaseError, match=r"materials\.sand\.granular.*missing; grains yield by"):
        coupled_cases.simulation(comm, data)
