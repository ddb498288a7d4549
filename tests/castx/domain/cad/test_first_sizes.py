"""Sizes of cells at the interfaces of a first mesh, for skins and for what the mould takes up."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.case.cad.process_template import process_text
from castx.case.cad.template import NewCase, case_text
from castx.case.processes.plan import plan_of
from castx.case.processes.process import casting_process
from castx.case.reading.read import load_case
from castx.case.skin import MOST_GROWTH
from castx.case.soak import soaks
from castx.domain.cad.first_sizes import with_interface_size, with_soaked_cells
from castx.domain.cad.new_case import new_case
from castx.domain.source import named_mesh
from castx.input.toml_text import parse_toml
from tests.cad_files import two_blocks, write_cad

pytestmark = pytest.mark.serial


def test_cells_in_the_skin_follow_from_it_as_far_as_the_mesh_may_grow(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    plain = new_case(path, tmp_path / "a.toml")
    case = with_interface_size(plain)
    assert plain.interface_size is None
    assert case.interface_size is not None and case.interface_size < case.size
    counts = []
    for each in (plain, case):
        (tmp_path / "a.toml").write_text(case_text(each))
        read = load_case(tmp_path / "a.toml")
        counts.append(len(named_mesh(read.geometry, [body.name for body in read.bodies]).cells))
    assert read.geometry.cad.interface_size == case.interface_size
    assert 1.1 * counts[0] < counts[1] <= MOST_GROWTH[3] * counts[0]


def test_a_skin_of_many_cells_needs_no_others(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    fine = replace(new_case(path, tmp_path / "a.toml"), size=1e-4)
    assert with_interface_size(fine) == fine
    assert "interface_size" not in case_text(fine)


def plate_in_sand(length, thickness, size):
    """Return a plate in a block of sand, a quarter of its length round it [m], as first meshed."""
    volume, area = length**2 * thickness, 2.0 * length**2 + 4.0 * length * thickness
    side, height = 1.5 * length, thickness + 0.5 * length
    outside = 2.0 * side**2 + 4.0 * side * height
    return NewCase(
        "plate.step", size, 0.25 * length,
        (("plate", volume), ("mould", side**2 * height - volume)),
        (("plate", "mould", area),), (("mould/outside", outside),),
        interface_size=0.6 * size,
    )  # fmt: skip


def of_iron(case):
    """Return the text of a case of iron in sand."""
    modulus = case.modulus("plate")
    plan = plan_of(casting_process("sand"), "GJL-250", None, modulus)
    return process_text(case, plan, "cast iron")


def cells_foreseen(case, growth):
    """Return the cells of tetrahedra that grow evenly from both sides of the plate [1]."""
    a, b = case.interface_size, case.size
    layers = 0.5 / a**2 - 0.5 / b**2 - (b - a) / b**3
    volume = sum(size for _, size in case.bodies) / b**3
    return 6.7 * (volume + 1.3 * 2.0 * case.interfaces[0][2] * layers / growth**0.5)


def test_sand_that_takes_the_heat_of_a_thin_casting_has_cells_for_it():
    """Cells of 6 mm would let it freeze two thirds too early."""
    told = []
    plain = plate_in_sand(0.04, 0.004, 0.01)
    case = with_soaked_cells(plain, of_iron(plain), told.append)
    assert case == replace(plain, interface_size=case.interface_size, growth=case.growth)
    (soak,) = soaks(load_case(parse_toml(of_iron(case))), {"plate": case.modulus("plate")})
    assert soak.error(1.4 * plain.interface_size) > 0.5
    assert soak.error(1.4 * case.interface_size) == pytest.approx(0.05, rel=0.1)
    assert cells_foreseen(case, case.growth or 0.4) < 30_000
    assert len(told) == 1 and "takes up the heat of freezing" in told[0]


def test_a_thin_casting_whose_sand_takes_too_many_cells_gets_those_of_a_first_run():
    told = []
    plain = plate_in_sand(0.08, 0.005, 0.01)
    case = with_soaked_cells(plain, of_iron(plain), told.append)
    assert case.growth == 1.0 and case.interface_size < 0.4 * plain.interface_size
    assert cells_foreseen(case, 1.0) == pytest.approx(30_000, rel=0.1)
    assert "as fine as a first run can afford" in told[0] and told[0].endswith("0 cells")


@pytest.mark.parametrize("length, thickness, size", [(0.1, 0.05, 0.01), (2.0, 0.005, 0.01)])
def test_sand_round_thick_and_very_large_castings_keeps_its_cells(length, thickness, size):
    plain = plate_in_sand(length, thickness, size)
    told = []
    assert with_soaked_cells(plain, of_iron(plain), told.append) == plain and not told
