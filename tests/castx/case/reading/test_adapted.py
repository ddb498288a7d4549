"""A case in a mesh with the sizes of a file, and with errors in its cells."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.adapted import error_fields, with_fields, with_size_map
from castx.case.reading.read import load_case
from tests.castx.command_line import CASE

pytestmark = pytest.mark.serial


def case_of(tmp_path, *overrides):
    text = CASE.replace("casting/base", "casting/outside").replace("mould/base", "mould/outside")
    cad = '[geometry]\nmodel = "3d"\nfile = "part.step"\nsize = "5 mm"\n'
    path = tmp_path / "case.toml"
    path.write_text(cad + text[text.index("[[bodies]]") :])
    return load_case(path, overrides)


@pytest.mark.parametrize(
    "scheme, names",
    [
        ("iterated", ("stress_error", "heat_flux_error")),
        ("thermal", ("heat_flux_error",)),
        ("mechanical", ("stress_error",)),
    ],
)
def test_errors_are_those_of_what_a_run_solves(tmp_path, scheme, names):
    assert error_fields(case_of(tmp_path, f"coupling.scheme={scheme}")) == names


def test_fields_and_sizes_are_those_that_are_given(tmp_path):
    case = case_of(tmp_path)
    assert with_fields(case, ["gap", "stress_error"]).output.fields == ("gap", "stress_error")
    assert case.geometry.cad.size_map is None
    mapped = with_size_map(case, Path("/runs/sizes.vtu"))
    assert mapped.geometry.cad.size_map == Path("/runs/sizes.vtu")
    assert mapped.geometry.cad.size == case.geometry.cad.size
