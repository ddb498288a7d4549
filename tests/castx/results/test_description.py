"""What run.json says of a case: planes of symmetry, strengths of materials."""

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.domain.mesh import build_mesh
from castx.results.description import symmetry_planes, tensile_strength
from tests.coupled_cases import cylinder


def test_planes_of_symmetry_are_recorded(comm):
    geometry = {"model": "3d", "sector": "quarter"}
    case = read_case(cylinder({"geometry": geometry}, size=0.01), Path("case.toml"))
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    planes = symmetry_planes(mesh, "casting")
    assert sorted(np.abs(plane["normal"]).round(12).tolist() for plane in planes) == [
        [0.0, 1.0, 0.0], [1.0, 0.0, 0.0],
    ]  # fmt: skip
    assert [plane["offset"] for plane in planes] == pytest.approx([0.0, 0.0], abs=1e-15)


@pytest.mark.serial
def test_the_tensile_strength_is_that_at_room_temperature():
    materials = {
        "metal": {"extends": "Al-pure", "tensile_strength": [[0, 100e6], [100, 50e6]]}
    }
    case = read_case(cylinder({"materials": materials}, size=0.01), Path("case.toml"))
    assert tensile_strength(case, "metal") == pytest.approx(90e6)
    assert tensile_strength(case, "Al-pure") is None
