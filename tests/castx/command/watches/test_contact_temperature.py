"""The temperature of faces that touch, by half-spaces, and with the latent heat of a melt."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.watches.contact_temperature import contact_temperature, effusivity
from castx.materials.lookup import find_material
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

METAL = {
    "density": 2500, "heat_capacity": 1000, "conductivity": 160, "solidus": 500, "liquidus": 600,
    "latent_heat": 4e5,
}  # fmt: skip
MOULD = {"density": 8000, "heat_capacity": 500, "conductivity": 25}


def case_of(metal=METAL, **changes):
    content = cylinder(
        bodies__0__material="metal", bodies__1__material="steel", bodies__0__temperature=700,
        coupling__scheme="thermal", **{"bodies__1__temperature": 200, **changes},
    )  # fmt: skip
    content["materials"] = {"metal": metal, "steel": MOULD}
    return read_case(content, Path("case.toml"))


def test_half_spaces_meet_between_their_temperatures():
    """B = √(160·2500·(1000 + 4e5/500)) of the metal and √(25·8000·500) of the mould."""
    case = case_of()
    hot, cold = np.sqrt(160 * 2500 * 1800.0), np.sqrt(25 * 8000 * 500.0)
    expected = (hot * 700 + cold * 200) / (hot + cold)
    assert effusivity(find_material("metal", case.materials), 200, 700) == pytest.approx(hot)
    assert contact_temperature(case, case.bodies[1]) == pytest.approx(expected)
    assert contact_temperature(case, case.bodies[0]) is None, "nothing is hotter than the metal"


def test_latent_heat_and_heat_of_the_metal_take_the_mould_farther():
    without = {k: v for k, v in METAL.items() if k not in ("solidus", "liquidus", "latent_heat")}
    mould = case_of().bodies[1]
    usual = contact_temperature(case_of(), mould)
    assert contact_temperature(case_of(without), mould) < usual - 20.0
    assert contact_temperature(case_of({**METAL, "conductivity": 300}), mould) > usual + 20.0


def test_a_temperature_that_is_not_known_has_none():
    case = case_of(bodies__1__temperature={"formula": "200 + 0*r"})
    assert contact_temperature(case, case.bodies[1]) is None
