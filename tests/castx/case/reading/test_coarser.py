"""A case in a coarser mesh and in larger steps."""

import math

import pytest

from castx.case.reading.coarser import with_coarser_mesh, with_larger_steps
from castx.case.reading.read import load_case
from castx.errors import CaseError
from tests.castx.command_line import CASE

pytestmark = pytest.mark.serial


def case_of(tmp_path, *overrides, text=CASE):
    path = tmp_path / "case.toml"
    path.write_text(text)
    return load_case(path, overrides)


def test_all_sizes_of_a_generator_grow(tmp_path):
    case = case_of(tmp_path, 'geometry.interface_size="2 mm"')
    found = with_coarser_mesh(case, 1.5).geometry.arguments
    assert (found["size"], found["interface_size"]) == pytest.approx((0.0075, 0.003))
    assert found["radius"] == 0.02


def test_a_size_that_castx_finds_grows_with_the_others(tmp_path):
    case = case_of(tmp_path, 'geometry.interface_size="auto"', "geometry.radius=0.06")
    own = case.geometry.arguments["interface_size"]
    found = with_coarser_mesh(case, 2.0).geometry.arguments["interface_size"]
    assert found == pytest.approx(2.0 * own)


def test_no_finer_cells_at_the_interface_remain_none(tmp_path):
    case = case_of(tmp_path, 'geometry.interface_size="auto"', "geometry.size=2e-4")
    assert "interface_size" not in case.geometry.arguments
    assert "interface_size" not in with_coarser_mesh(case, 2.0).geometry.arguments


def test_sizes_of_a_cad_part_grow_by_its_refinement(tmp_path):
    geometry = CASE.index("[geometry]"), CASE.index("[[bodies]]")
    cad = '[geometry]\nmodel = "3d"\nfile = "part.step"\nsize = "5 mm"\nrefinement = 3\n'
    text = cad + CASE[geometry[1] :].replace("casting/base", "casting/outside")
    text = text.replace("mould/base", "mould/outside")
    assert with_coarser_mesh(case_of(tmp_path, text=text), 1.5).geometry.cad.refinement == 2.0


def test_a_mesh_of_a_file_stays(tmp_path):
    geometry = CASE.index("[geometry]"), CASE.index("[[bodies]]")
    text = '[geometry]\nmodel = "3d"\nfile = "part.msh"\n' + CASE[geometry[1] :]
    with pytest.raises(CaseError, match="file"):
        with_coarser_mesh(case_of(tmp_path, text=text), 2.0)


def test_all_that_bounds_steps_grows(tmp_path):
    given = ["time.end=10", "time.solid_fraction_change=0.6", "time.smallest_step=1e-4"]
    case = case_of(tmp_path, *given)
    time = with_larger_steps(case, 2.0).time
    assert (time.first_step, time.largest_step, time.end) == pytest.approx((0.1, 0.2, 10.0))
    assert time.smallest_step == pytest.approx(2e-4)
    assert time.temperature_change == 2.0 * case.time.temperature_change
    assert time.skin_change == pytest.approx(2.0 * case.time.skin_change)
    assert (time.solid_fraction_change, time.fixed_step) == (1.0, None)
    assert with_larger_steps(case_of(tmp_path, "time.fixed_step=0.1"), 1.5).time.fixed_step == (
        pytest.approx(0.15)
    )


def test_no_step_exceeds_the_run(tmp_path):
    case = case_of(tmp_path, "time.largest_step=0.15")
    assert with_larger_steps(case, 2.0).time.largest_step == 0.2


def test_tolerances_grow_and_what_they_replace_stays_free(tmp_path):
    given = ['time.tolerance={ temperature = "2 K", gap = "3 um" }', "time.skin_change=0.2"]
    time = with_larger_steps(case_of(tmp_path, *given), 2.0).time
    assert (time.tolerance.temperature, time.tolerance.strain) == (4.0, None)
    assert time.tolerance.gap == pytest.approx(6e-6)
    assert time.wanted("skin_change") == 0.4
    assert time.wanted("solid_fraction_change") == math.inf
