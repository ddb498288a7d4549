"""Candidates are drawn where they lie, at their depth below a surface."""

import pytest

from castx.case.reading.read import load_case
from castx.domain.mesh import build_mesh
from castx.studies.asked.candidates import CandidateSensor
from castx.studies.inverse.design_picture import draw_design, marks_of
from tests.castx.many_runs import CASE

pytestmark = pytest.mark.serial

HERE = {"at": ["30 mm", "0.5 mm"], "below": "casting/mould"}
PLACES = [
    {"name": "die", "body": "mould", "depth": "4 mm", **HERE},
    {"name": "metal", "body": "casting", "depth": "3 mm", **HERE},
    {"name": "axis", "body": "casting", "at": [0, 0], "direction": [1, 0]},
]


def test_marks_lie_at_their_depth_and_carry_their_number(comm, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path / "case.toml")
    mesh = build_mesh(case.geometry, ["casting", "mould"], comm)
    places = [CandidateSensor.read(one) for one in PLACES]
    marks = marks_of(case, mesh, places, ["metal", "die"])
    assert [one.name for one in marks] == ["2. die", "1. metal", "axis"]
    wanted = [(0.034, 0.0005), (0.027, 0.0005), (0.0, 0.0)]
    for one, at in zip(marks, wanted, strict=True):
        assert one.at == pytest.approx(at, abs=1e-12)
    draw_design(case, places, ["die"], comm, tmp_path / "design.png")
    assert (tmp_path / "design.png").stat().st_size > 5000
