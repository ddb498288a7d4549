"""What the quantities take from a material: each key arrives, and each missing one is named."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.foundry.alloy import Alloy
from castx.materials.lookup import find_material
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial


def test_every_key_arrives():
    fatigue = {
        "strength": 2e9, "strength_exponent": -0.08, "ductility": 0.4, "ductility_exponent": -0.65,
    }  # fmt: skip
    found = Alloy(
        alloy(
            melt_viscosity=1.3e-3,
            arm_spacing={"coefficient": 5e-5, "exponent": 0.4},
            solidification_shrinkage=0.05,
            cavitation=4e4,
            coalescence=0.95,
            strength={"base": 8e7, "slope": 3e5},
            tensile_strength=[[20, 2e8], [400, 5e7]],
            critical_strain=0.013,
            fatigue=fatigue,
        )
    )
    melt = found.melt()
    assert (melt.viscosity, melt.cavitation) == (1.3e-3, 4e4)
    assert melt.contraction == pytest.approx(0.05 / 0.95, rel=1e-14)
    assert found.spacing(np.array([32.0]))[0] == pytest.approx(5e-5 / 4.0, rel=1e-12)
    assert found.cut_off == pytest.approx(0.05)
    assert (found.strength.base, found.strength.slope) == (8e7, 3e5)
    assert found.tensile_strength(210.0) == pytest.approx(1.25e8)
    assert found.critical_strain == 0.013
    assert found.fatigue.cycles(np.array([0.008]), 205e9)[0] == pytest.approx(63942.07, rel=1e-6)
    assert (found.path.solidus, found.path.liquidus) == (550.0, 610.0)


def test_defaults_are_those_of_the_manual():
    found = Alloy(alloy(melt_viscosity=1e-3, solidification_shrinkage=0.05))
    assert found.cut_off == pytest.approx(0.02)
    assert found.melt().cavitation == 1.01e5 and found.melt(2e3).cavitation == 2e3


@pytest.mark.parametrize(
    ("quantity", "key"),
    [
        ("spacing", "arm_spacing"), ("shrinkage", "solidification_shrinkage"),
        ("strength", "strength"), ("tensile_strength", "tensile_strength"),
        ("critical_strain", "critical_strain"), ("fatigue", "fatigue"),
    ],
)  # fmt: skip
def test_what_is_missing_is_named_with_its_cure(quantity, key):
    with pytest.raises(CaseError, match=rf"has no {key}, needed by .*; add to \[materials.alloy\]"):
        getattr(Alloy(alloy()), quantity)
    with pytest.raises(CaseError, match="has no melt_viscosity, solidification_shrinkage, needed"):
        Alloy(alloy()).melt()


def test_indices_of_hot_tearing():
    """Scheil with k = 0.17 and T_m - T_L = 14.3 K, and a metal that freezes at one temperature."""
    scheil = {"solid_fraction": "scheil", "partition_coefficient": 0.17, "melting_point": 660.3,
              "liquidus": 646.0, "solidus": 0.0}  # fmt: skip
    found = Alloy(alloy(**scheil)).tearing_indices
    assert found == {
        "kou": pytest.approx(3962.701, rel=1e-5), "clyne_davies": pytest.approx(7.443063, rel=1e-6)
    }  # fmt: skip
    assert Alloy(find_material("Al-pure")).tearing_indices is None
    assert Alloy(find_material("sand-silica")).tearing_indices is None


CAST = (
    "AZ91", "AlCu4.5", "AlSi7Mg", "AlSi9Cu3", "AlSi10Mg", "AlSi12", "CuSn12", "G20Mn5",
    "GJL-250", "GJS-400", "GJS-600", "316L", "ZnAl4Cu1", "CuZn39Pb1Al",
)  # fmt: skip


@pytest.mark.parametrize("name", CAST)
def test_alloys_of_the_database_break_above_their_yield_stress(name):
    found = Alloy(find_material(name))
    strength, flow = found.tensile_strength, found.material.description.yield_stress
    assert flow is not None
    temperature = np.linspace(20.0, found.path.solidus, 50)
    assert np.all(strength(temperature) > flow(temperature))
    assert np.all(np.diff(strength(temperature)) < 0.0)
    if name[0] != "G" or name == "G20Mn5":  # graphite swells, and feeds itself
        assert found.melt().viscosity < 0.01 and 2e-5 < found.spacing(np.array(1.0)) < 4e-4


def test_pure_metals_and_sand_have_no_mush():
    with pytest.raises(CaseError, match="without a freezing range has no mush"):
        _ = Alloy(find_material("Al-pure")).path
    with pytest.raises(CaseError, match="never melts"):
        _ = Alloy(find_material("sand-silica")).path
