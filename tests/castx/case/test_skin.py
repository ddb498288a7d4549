"""Thickness of the skin that carries a gap, against numbers by hand."""

from math import log

import pytest

from castx.case.reading.read import load_case
from castx.case.skin import CELLS, MOST_GROWTH, chosen_text, finest, interface_size, skins
from tests.castx.command_line import CASE, content_of

pytestmark = pytest.mark.serial

METAL = (
    "materials.metal={density=2700, heat_capacity=1000, conductivity=100, latent_heat=4e5, "
    'solidus=600, liquidus=640, solid_fraction="linear", young_modulus=1e10, poisson_ratio=0.3, '
    "expansion=2e-5, stress_free=600, liquid={viscosity=1e6, coherency=0.75}}"
)
OURS = (METAL, "bodies.0.material=metal", "bodies.0.temperature=650")
WIDE = {"casting": 0.05}


def found(*overrides, moduli=WIDE):
    return skins(load_case(content_of(CASE), [*OURS, *overrides]), moduli)


def thickness(*overrides, modulus=0.05):
    (skin,) = found(*overrides, moduli={"casting": modulus})
    return skin.thickness


def by_hand(gap, mush, flow):
    """δ = k (g_c/(α 2 M) + T_coherent − T_solidus)/q."""
    return 100.0 * (gap / (2e-5 * 0.1) + mush) / flow


def test_a_limited_law_halves_at_twice_the_gap_at_which_it_begins_to_fall():
    expected = by_hand(2.0 * 0.05 / 2300.0, 10.0, 2300.0 * 400.0)
    assert thickness() == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("heat", "gap"),
    [
        ('{law="series", closed=2300, gas_conductivity=0.05}', 0.05 / 2300.0),
        ('{law="exponential", closed=2300, decay_length=1e-4}', 1e-4 * log(2.0)),
        ('{law="rational", closed=2300, half_gap=3e-5}', 3e-5),
    ],
)
def test_each_law_has_the_gap_that_halves_it(heat, gap):
    expected = by_hand(gap, 10.0, 2300.0 * 400.0)
    assert thickness(f"interfaces.0.heat={heat}") == pytest.approx(expected, rel=0.03)


def test_a_metal_that_freezes_at_one_temperature_has_no_mush():
    expected = by_hand(2.0 * 0.05 / 2300.0, 0.0, 2300.0 * 400.0)
    assert thickness("materials.metal.liquidus=600") == pytest.approx(expected, rel=0.03)


def test_a_skin_is_no_thicker_than_the_modulus():
    assert thickness(modulus=0.002) == 0.002


@pytest.mark.parametrize(
    "override",
    [
        "coupling.scheme=thermal",
        'interfaces.0.heat={law="constant", closed=2300}',
        'interfaces.0.heat={law="perfect"}',
        'interfaces.0.heat={law="none"}',
        "bodies.0.temperature=500",
        "bodies.1.temperature=650",
        'materials.metal.liquid="none"',
    ],
)
def test_nothing_is_foreseen_where_no_gap_matters(override):
    assert found(override) == []


def test_a_body_of_unknown_modulus_has_none():
    assert found(moduli={}) == []


def test_the_text_says_what_cells_make_of_the_gap():
    (skin,) = found(moduli={"casting": 0.0016})
    assert skin.proposal == pytest.approx(0.0016 / CELLS)
    coarse, fine = skin.text(8e-4), skin.text(1.6e-4)
    assert "cells of 0.8 mm in the skin of casting, 1.6 mm thick, that would" in coarse
    assert "up to 12 % off, freezing time up to 15 %" in coarse
    assert skin.error(8e-4) == pytest.approx(0.15)
    assert 'interface_size = "0.16 mm" would reduce this to 2 % and 3 %' in coarse
    assert fine.endswith("fine enough, early gaps within 2 %")


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_growth_of_the_number_of_cells_is_bounded(dimension):
    share = finest(1.0, dimension)
    many = (log(1.0 / share) / (1.0 - share)) ** dimension
    assert 0.9 * MOST_GROWTH[dimension] < many <= MOST_GROWTH[dimension]


def sized(*overrides):
    case = load_case(content_of(CASE), [*OURS, 'geometry.interface_size="auto"', *overrides])
    return case, case.geometry.arguments.get("interface_size")


def test_auto_is_the_proposal_where_the_mesh_may_grow_so_far():
    case, size = sized()
    (skin,) = skins(case, case.geometry.moduli)
    assert case.geometry.moduli == {"casting": pytest.approx(0.02 * 0.04 / (2 * 0.06))}
    assert size == skin.proposal == interface_size(case)
    assert case.content["geometry"]["interface_size"] == "auto"
    assert chosen_text(case).endswith(f"cells of {1e3 * size:.2g} mm at the interfaces")


def test_auto_is_bounded_by_the_growth_of_the_mesh():
    assert sized("geometry.size=2e-2")[1] == finest(2e-2, 2)
    assert sized("geometry.model=3d")[1] == finest(5e-3, 3)


def test_auto_is_nothing_where_all_cells_are_fine_enough():
    case, size = sized("geometry.size=5e-4")
    assert size is None and "no finer cells" in chosen_text(case)
    assert chosen_text(load_case(content_of(CASE))) is None
    assert sized("coupling.scheme=thermal")[1] is None
