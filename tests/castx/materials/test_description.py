"""What a material of a case may hold, and the messages when it does not."""

from __future__ import annotations

import pytest

from castx.errors import CaseError
from tests.castx.materials.descriptions import described

pytestmark = pytest.mark.serial

ALLOY = {"partition_coefficient": 0.13, "melting_point": 660.0}


def test_quantities_carry_units() -> None:
    material = described(
        density="2.7 g/cm^3",
        solidus="823.15 K",
        young_modulus=[["20 degC", "70 GPa"], [550, "10 GPa"]],
        liquid={"viscosity": "1 MPa*s", "coherency": 0.7},
    )
    assert material.density == pytest.approx(2700.0)
    assert material.solidus == pytest.approx(550.0)
    assert material.young_modulus is not None
    assert material.liquid is not None
    assert material.young_modulus.values.tolist() == pytest.approx([70e9, 10e9])
    assert material.liquid.viscosity(600.0) == pytest.approx(1e6)
    assert material.liquid.model == "viscous"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"solidus": 700}, r"^solidus: 700 °C lies above the liquidus, 610 °C$"),
        ({"solidus": None}, r"^solidus: missing; give it with liquidus"),
        ({"latent_heat": None}, r"^latent_heat: missing; a material that melts needs it"),
        ({"latent_heat": -1}, r"^latent_heat: must be at least 0"),
        ({"conductivity": [[20, 237], [600, -2]]}, r"^conductivity\[1\]: must be positive"),
        ({"heat_capacity": {"solid": 0, "liquid": 9}}, r"^heat_capacity.solid: must be positive"),
        ({"heat_capacity": {"solid": 9}}, r"^heat_capacity: liquid is missing"),
        ({"heat_capacity": {"solid": 9, "fluid": 9}}, r"^heat_capacity.fluid: unknown"),
        (
            {"conductivity": {"solid": [[600, 9], [20, 9]], "liquid": 9}},
            r"^conductivity.solid\[1\]: the first column must increase",
        ),
        ({"young_modulus": [[20, 7e10], [600, 0]]}, r"^young_modulus\[1\]: must be positive"),
        ({"poisson_ratio": 0.5}, r"^poisson_ratio: must be at least 0 and below 0.5"),
        ({"poisson_ratio": -0.1}, r"^poisson_ratio: must be at least 0 and below 0.5"),
        ({"density": "3 kg"}, r"^density: 'kg' is not a unit of"),
        ({"youngs_modulus": 7e10}, r'^youngs_modulus: unknown key.*did you mean "young_modulus"'),
        ({"solid_fraction": "schiel"}, r'^solid_fraction: unknown.*did you mean "scheil"'),
        ({"solid_fraction": "scheil"}, r"^partition_coefficient: missing.*melting_point: missing"),
        (
            {"solid_fraction": "scheil"} | ALLOY | {"melting_point": 600},
            r"^melting_point: must lie",
        ),
        (
            {"solid_fraction": "lever", "solidus": 610} | ALLOY,
            r"^solid_fraction: solidus and liquidus are equal",
        ),
        (ALLOY, r"^partition_coefficient: acts only with"),
        ({"solid_fraction": [[550, 1.2], [610, 0]]}, r"^solid_fraction\[0\]: must be at least 0"),
        ({"solid_fraction": [[550, 0.4], [610, 0.6]]}, r"^solid_fraction\[1\]: .* not increase"),
        ({"solid_fraction": [[600, 1], [550, 0]]}, r"^solid_fraction\[1\]: temperatures must not"),
        ({"solid_fraction": [[550, 1]]}, r"^solid_fraction: the solid fraction must fall"),
        ({"solid_fraction": [[560, 1], [610, 0]]}, r"^solidus: the table solid_fraction says 560"),
        ({"yield_stress": [[20, -6e7]]}, r"^yield_stress\[0\]"),
        ({"solidification_shrinkage": 1.5}, r"^solidification_shrinkage: must be above -1"),
        ({"hardening": -1e9}, r"^hardening: must"),
        ({"viscosity": 0}, r"^viscosity: must"),
        ({"exponent": 0}, r"^exponent: must be positive"),
        ({"liquid": {"viscosity": 1e6}}, r"^liquid.coherency: missing"),
        ({"liquid": {"viscosity": 1e6, "coherency": 1.5}}, r"^liquid.coherency: must be"),
        ({"liquid": "viscous"}, r'^liquid: a table of keys is needed, or "none": elastic'),
        ({"expansion": None, "expansion_reference": 20}, r"^expansion_reference: .* add expansion"),
        (
            {"solidus": None, "liquidus": None},
            r"^latent_heat: acts only in a material that melts.*heat_capacity.liquid: acts only",
        ),
        (
            {"solidus": None, "liquidus": None, "latent_heat": None, "solid_fraction": "linear"},
            r"^solid_fraction: acts only in a material that melts",
        ),
    ],
)
def test_refusals(changes, message) -> None:
    with pytest.raises(CaseError, match=message):
        described(**changes)


def test_what_asks_for_nothing_is_accepted() -> None:
    assert not described(solidification_shrinkage=0.0, hardening=0).hardening.acts


def test_a_liquid_may_be_refused_expressly() -> None:
    assert described(liquid="none").liquid is None


def test_part_of_a_material_is_checked_when_it_is_complete() -> None:
    assert described(extends="Al-pure", solidus=700).solidus == 700.0
