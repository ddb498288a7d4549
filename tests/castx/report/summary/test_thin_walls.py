"""What a report says about walls with few cells across them."""

from dataclasses import asdict, replace

import pytest

from castx.foundry.bending import ThinWalls
from castx.report.summary.estimated import error_texts
from castx.report.summary.thin_walls import thin_walls
from castx.results.files.estimate import Coarser, Estimate
from tests.castx.report.summary.fake_run import run

pytestmark = pytest.mark.serial

LID = ThinWalls(
    body="lid", cells="triangles", formulation="mixed", one=0.0, two=0.4, few=0.5,
    thinnest=2e-3, thickest=3e-3, across=2.0, error=-0.31, error_if_fine=-0.10,
)  # fmt: skip


def fake():
    bodies = {"lid": {"thin_walls": asdict(LID)}, "die": {"thin_walls": None}, "old": {}}
    return run(record=run().record | {"bodies": bodies})


def test_the_error_of_bending_stands_among_the_findings():
    (found,) = thin_walls(fake())
    assert (found.name, found.number) == ("Bending of thin walls: lid", "-31 %")
    assert found.sentence == (
        "Estimated error of the deflection: lid has walls of 2 to 3 mm with few cells across (of "
        "its surface 40 % with 2, 10 % with 3): triangles (mixed) bend there about 31 % too "
        "little, and distortion and stress of bending are off by as much; cells of 0.5 mm there, 4 "
        "across, leave 10 %."
    )


def test_what_freezing_leaves_is_a_finding_of_its_own():
    box = replace(
        LID,
        error=None,
        error_if_fine=None,
        freezing_error=(0.5, 0.2),
        freezing_error_if_fine=(0.2, 0.05),
    )
    (found,) = thin_walls(
        run(record=run().record | {"bodies": {"lid": {"thin_walls": asdict(box)}}})
    )
    assert (found.name, found.number) == ("Residual stress of thin walls: lid", "50 %")
    assert "the distortion by it up to 20 %" in found.sentence
    both = replace(box, error=-0.31, error_if_fine=-0.10)
    record = run().record | {"bodies": {"lid": {"thin_walls": asdict(both)}}}
    bending, freezing = thin_walls(run(record=record))
    assert "residual stress" not in bending.sentence and "31 %" not in freezing.sentence


def test_a_coarser_mesh_says_nothing_of_its_error():
    (found,) = thin_walls(fake())
    other = Coarser(folder="a", ratio=2.0, ended="finished", values={found.name: -0.64})
    estimate = Estimate(reached=1.0, values={found.name: found.value}, mesh=other, steps=other)
    assert error_texts(found, estimate) == ("", "")
