"""Keys of the foundry in a material: what is read, and what is refused."""

import pytest

from castx.input.problems import Refusal
from castx.materials.sources import unit_of
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial

FATIGUE = {
    "strength": "2000 MPa", "strength_exponent": -0.08, "ductility": 0.4,
    "ductility_exponent": -0.65,
}  # fmt: skip
KEYS = {
    "melt_viscosity": "1.2e-3 Pa*s",
    "arm_spacing": {"coefficient": 4e-5},
    "coalescence": 0.97,
    "critical_strain": 0.02,
    "strength": {"base": "80 MPa", "slope": 2e5},
    "tensile_strength": [[20, "240 MPa"], [500, "5 MPa"]],
    "fatigue": FATIGUE,
}


def test_all_keys_are_read():
    found = described(**KEYS)
    assert (found.melt_viscosity, found.coalescence, found.critical_strain) == (1.2e-3, 0.97, 0.02)
    assert found.arm_spacing is not None and found.strength is not None
    assert (found.arm_spacing.coefficient, found.arm_spacing.exponent) == (4e-5, 1.0 / 3.0)
    assert (found.strength.base, found.strength.slope) == (80e6, 2e5)
    assert found.tensile_strength is not None and found.tensile_strength(20.0) == 240e6
    assert found.fatigue is not None and found.fatigue.strength == 2000e6
    assert found.fatigue.ductility_exponent == -0.65


def test_a_number_is_a_constant_spacing():
    spacing = described(arm_spacing="35 um").arm_spacing
    assert spacing is not None
    assert spacing.coefficient == pytest.approx(35e-6) and spacing.exponent == 0.0


def test_every_number_has_its_unit():
    rows = {row.property: (row.value, row.unit) for row in alloy(**KEYS).rows()}
    assert rows["arm_spacing.coefficient"] == (4e-5, "m (K/s)^exponent")
    assert rows["strength.slope"] == (2e5, "Pa m^0.5")
    assert rows["fatigue.strength"] == (2000e6, "Pa")
    assert rows["melt_viscosity"] == (1.2e-3, "Pa s")
    assert "arm_spacing.exponent" not in rows  # a default
    assert unit_of("tensile_strength") == ("Pa", "MPa", 1e-6)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"melt_viscosity": 0.0}, "melt_viscosity: must be positive"),
        ({"arm_spacing": {"exponent": 0.3}}, r"arm_spacing.coefficient: missing"),
        ({"arm_spacing": {"coefficient": "4e-5 m"}}, r"plain number in m\*\(K/s\)\^exponent"),
        ({"arm_spacing": {"coefficient": 4e-5, "exponent": -1}}, "arm_spacing.exponent: must be"),
        ({"arm_spacing": "3 s"}, "arm_spacing: 's' is not a unit of length"),
        ({"coalescence": 1.0}, "coalescence: must be positive and below 1"),
        ({"critical_strain": -0.1}, "critical_strain: must be positive"),
        ({"strength": 8e7}, "strength: a table of keys is needed: { base, slope }"),
        ({"strength": {"base": 8e7}}, "strength.slope: missing"),
        ({"tensile_strength": [[20, 0.0]]}, r"tensile_strength\[0\].*must be positive"),
        ({"fatigue": FATIGUE | {"ductility_exponent": 0.6}}, "fatigue.ductility_exponent: must be"),
        ({"fatigue": {**FATIGUE, "strenght": 3}}, "fatigue.strenght: unknown"),
        ({"fatigue": 3}, "fatigue: a table of keys is needed"),
    ],
)
def test_refused(keys, text):
    with pytest.raises(Refusal, match=text):
        described(**keys)


def test_what_never_melts_has_no_mush():
    cold = {"latent_heat": None, "solidus": None, "liquidus": None, "heat_capacity": 1e3}
    cold |= {"conductivity": 100.0}
    with pytest.raises(Refusal, match="arm_spacing: acts only in a material that melts"):
        described(**cold, arm_spacing=3e-5)
    assert described(**cold, fatigue=FATIGUE).fatigue is not None
