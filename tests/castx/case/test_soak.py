"""Depth to which a mould takes the heat of freezing, against numbers by hand and runs."""

from math import pi

import pytest

from castx.case.reading.read import load_case
from castx.case.soak import soaks
from castx.process.simulation import Simulation
from tests.castx.command_line import CASE, content_of

pytestmark = pytest.mark.serial

METAL = (
    "materials.metal={density=2500, heat_capacity=1000, conductivity=100, latent_heat=4e5, "
    'solidus=600, liquidus=640, solid_fraction="linear"}'
)
MOULD = "materials.grains={density=1600, heat_capacity=1000, conductivity=0.5}"
OURS = (
    "coupling.scheme=thermal", METAL, "bodies.0.material=metal", "bodies.0.temperature=650",
    MOULD, "bodies.1.material=grains", "bodies.1.temperature=20", "probes=[]",
    'output.fields=["temperature"]',
    'interfaces.0.heat={law="series", closed=1000, gas_conductivity=0.05}',
)  # fmt: skip


def found(*overrides, moduli=None):
    case = load_case(content_of(CASE), [*OURS, *overrides])
    return list(soaks(case, moduli or {"casting": 0.004}))


def test_depth_and_share_are_those_of_a_half_space():
    (soak,) = found()
    heat = 0.004 * 2500.0 * (4e5 + 50.0 * 1000.0)  # [J/m²]
    assert (soak.mould, soak.casting) == ("mould", "casting")
    assert soak.depth == pytest.approx(heat / (1.6e6 * 600.0), rel=1e-6)
    face, inside = heat / 6e5, pi / 4.0 * (heat / 600.0) ** 2 / (0.5 * 1.6e6)
    assert soak.share == pytest.approx(inside / (face + inside), rel=1e-6)


def test_the_text_says_what_cells_of_the_mould_make_of_the_time():
    (soak,) = found()
    assert soak.depth == pytest.approx(4.6875e-3) and soak.share == pytest.approx(0.880, abs=1e-3)
    text = soak.text(8e-3)
    assert "cells of 8 mm in mould, which takes up the heat of freezing 4.7 mm deep" in text
    assert "casting freezes up to 38 % too early" in text  # 0.880 0.15 (8/4.6875)²
    assert 'interface_size = "2.8 mm" would reduce this to 5 %' in text
    assert soak.error(1.0) == soak.share
    assert soak.text(2.8e-3) is None


def test_metal_conducts_so_well_that_little_of_the_time_is_its_own():
    (soak,) = found("materials.grains.conductivity=30", "materials.grains.density=7800")
    assert soak.share < 0.05 and soak.text(1.0) is None


@pytest.mark.parametrize(
    "override",
    [
        "bodies.0.temperature=500",
        "bodies.1.temperature=640",
        'interfaces.0.heat={law="constant", closed=1000}',
        'interfaces.0.heat={law="none"}',
    ],
)
def test_nothing_is_foreseen_where_nothing_freezes_or_no_gap_counts(override):
    assert found(override) == []


def test_a_body_of_unknown_modulus_takes_nothing():
    assert found(moduli={"mould": 0.1}) == []


PLATE = """
[geometry]
generator = "two_slabs"
model = "plane-strain"
cells = "quadrilaterals"
length = "4.6 mm"
mould_length = "60 mm"
width = "17 mm"
size = "17 mm"
[[bodies]]
name = "casting"
material = "GJL-250"
temperature = 1315
law = "thermo-elastic"
[[bodies]]
name = "mould"
material = "sand-silica"
temperature = 20
law = "thermo-elastic"
[[interfaces]]
bodies = ["casting", "mould"]
heat = { from = "iron-sand-coated" }
[coupling]
scheme = "thermal"
[time]
end = "200 s"
[output]
fields = ["temperature"]
"""


def frozen_after(comm, size):
    """Return when a plate of iron in sand has frozen [s], and what is foreseen of its cells."""
    case = load_case(content_of(PLATE), [f"geometry.size={size}"])
    (soak,) = soaks(case, {"casting": 4.6e-3})
    for state in Simulation.from_case(case, comm):
        if state.totals["casting.solid_fraction"] > 0.9999:
            return state.time, soak.error(size)
    raise AssertionError("it has not frozen")


@pytest.mark.slow
def test_coarse_sand_freezes_iron_as_much_too_early_as_is_foreseen(comm):
    fine, small = frozen_after(comm, 1e-3)
    assert small < 0.01  # of what is left to finer cells
    for size, least in ((4e-3, 0.0), (8e-3, 0.1), (17e-3, 0.7)):
        coarse, foreseen = frozen_after(comm, size)
        assert least - 0.05 < 1.0 - coarse / fine < foreseen < least + 0.2
