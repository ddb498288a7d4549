from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from castx.materials.conduction_potential import conduction_potential
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material

pytestmark = pytest.mark.serial


def metal(**properties):
    given = {
        "density": 2700.0,
        "heat_capacity": {"solid": [[20, 900], [660, 1180]], "liquid": 1050},
        "conductivity": {"solid": [[20, 237], [300, 230], [660, 210]], "liquid": 95},
        "latent_heat": 397e3,
    }
    description = MaterialDescription.read(given | properties)
    return find_material("metal", {"metal": description})


ISOTHERMAL = metal(solidus=660, liquidus=660)
ALLOY = metal(solidus=560, liquidus=615)
EUTECTIC = metal(
    solidus=577,
    liquidus=615,
    solid_fraction="scheil",
    partition_coefficient=0.13,
    melting_point=660,
)


def conductivity(material, temperature: float) -> float:
    curve = material.enthalpy
    fraction = curve.solid_fraction(curve.enthalpy(temperature))
    return float(material.conductivity(temperature, fraction))


@pytest.mark.parametrize("material", [ISOTHERMAL, ALLOY, EUTECTIC])
@pytest.mark.parametrize("ends", [(-50.0, 10.0), (20.0, 400.0), (550.0, 700.0), (900.0, 1000.0)])
def test_potential_is_the_integral_of_the_conductivity(material, ends):
    potential = conduction_potential(material)
    found = np.diff(potential(np.array(ends)))[0]
    corners = [T for T in (20, 300, 560, 577, 615, 660) if ends[0] < T < ends[1]]
    wanted, _ = quad(
        lambda T: conductivity(material, T), *ends, points=corners or None, limit=400
    )
    assert found == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("material", [ISOTHERMAL, ALLOY, EUTECTIC])
def test_derivative_is_that_of_the_potential(material):
    potential = conduction_potential(material)
    T = np.linspace(-31.0, 931.0, 1001)
    difference = (potential(T + 1e-4) - potential(T - 1e-4)) / 2e-4
    smooth = np.abs(T[:, None] - np.array([577.0, 660.0])).min(axis=1) > 1e-3
    assert difference[smooth] == pytest.approx(potential.derivative(T)[smooth], rel=1e-5)


@pytest.mark.parametrize("material", [ISOTHERMAL, ALLOY])
def test_derivative_is_the_conductivity_itself(material):
    """To all digits where k is straight, on either side of what the tables have."""
    T = np.array([-40.0, 20.0, 20.1, 299.9, 300.0, 301.0, 559.9, 660.1, 900.0])
    wanted = [conductivity(material, temperature) for temperature in T]
    assert conduction_potential(material).derivative(T) == pytest.approx(wanted, rel=1e-9)


def test_conductivity_jumps_at_the_melting_point():
    potential = conduction_potential(ISOTHERMAL)
    below = np.nextafter(660.0, 0.0)
    assert potential.derivative(np.array([below, 660.0])) == pytest.approx([210.0, 95.0], rel=1e-6)
    assert potential(np.array([660.0])) == pytest.approx(potential(np.array([below])), rel=1e-12)


def test_the_mush_is_integrated_in_pieces():
    """Between solidus and liquidus k bends though the enthalpy runs straight: k table times f_s."""
    steep = metal(
        solidus=500,
        liquidus=600,
        heat_capacity=1000,
        conductivity={"solid": [[20, 237], [660, 100]], "liquid": 95},
    )
    wanted, _ = quad(lambda T: conductivity(steep, T), 500.0, 600.0)
    found = np.diff(conduction_potential(steep)(np.array([500.0, 600.0])))[0]
    assert found == pytest.approx(wanted, rel=2.5e-3)
    one_piece = 50.0 * (conductivity(steep, 500.0 + 1e-9) + conductivity(steep, 600.0))
    assert abs(one_piece - wanted) > 10 * abs(found - wanted)
