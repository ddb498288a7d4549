"""Keys of grains: refused by name, and a cone that meets Mohr and Coulomb."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.description import MaterialDescription
from castx.materials.flow import law_problems
from castx.materials.granular import GRANULAR, GranularData, granular_surface

COLD = np.array([20.0, 500.0])
GIVEN = {"cohesion": [(20.0, 1e6), (500.0, 1e4)], "friction_angle": 35.0}


@pytest.mark.parametrize("angle", [0.0, 20.0, 35.0])
def test_cone_meets_mohr_and_coulomb_in_compression(angle) -> None:
    found = granular_surface(GranularData.read(GIVEN | {"friction_angle": angle}), COLD)
    side, sine, cosine = 3e5, np.sin(np.radians(angle)), np.cos(np.radians(angle))
    cohesion = np.array([1e6, 1e4])
    axial = (2 * cohesion * cosine + side * (1 + sine)) / (1 - sine)
    q, p = axial - side, -(axial + 2 * side) / 3
    assert np.allclose(q + found.friction * p, found.strength)


def test_cut_off_is_the_tip_of_the_cone_unless_a_lower_one_is_given() -> None:
    tip = np.array([1e6, 1e4]) / np.tan(np.radians(35.0))
    lower = [(20.0, 5e5), (500.0, 9e4)]
    assert np.allclose(granular_surface(GranularData.read(GIVEN), COLD).cut_off, tip)
    given = GranularData.read(GIVEN | {"tension_cut_off": lower})
    assert np.allclose(granular_surface(given, COLD).cut_off, [5e5, tip[1]])
    without = GranularData.read({"cohesion": 1e6, "friction_angle": 0.0})
    assert np.isinf(granular_surface(without, COLD).cut_off).all()


def test_dilatancy_is_the_slope_of_its_own_angle_and_zero_by_default() -> None:
    assert granular_surface(GranularData.read(GIVEN), COLD).dilatancy == 0
    same = granular_surface(GranularData.read(GIVEN | {"dilatancy_angle": 35.0}), COLD)
    assert same.dilatancy == same.friction > 0


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"dilatancy_angle": 40.0}, "dilatancy_angle.*40° lies above friction_angle, 35°.*lower"),
        ({"cohesion": 0.0, "friction_angle": 0.0}, "cohesion.*no shear would be borne; raise one"),
        ({"cohesion": -1.0}, "cohesion"),
        ({"friction_angle": 90.0}, "friction_angle"),
        ({"cap": 1.0}, "cap.*unknown"),
    ],
)
def test_what_cannot_be_is_refused_by_name(changes, text) -> None:
    with pytest.raises(CaseError, match=text):
        MaterialDescription.read({"granular": GIVEN | changes})


def test_a_law_without_its_data_is_refused_with_the_cure() -> None:
    (key, text), = law_problems(MaterialDescription.read({}), GRANULAR)
    assert key == "granular" and "cohesion = ..., friction_angle = ..." in text and "rigid" in text
    melting = {"solidus": 500.0, "liquidus": 600.0, "latent_heat": 1.0, "granular": GIVEN,
               "liquid": {"viscosity": 1e6, "coherency": 0.5}}  # fmt: skip
    (key, text), = law_problems(MaterialDescription.read(melting), GRANULAR)
    assert key == "liquid" and "grains do not melt" in text
    assert not list(law_problems(MaterialDescription.read({"granular": GIVEN}), GRANULAR))
