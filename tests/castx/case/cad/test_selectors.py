"""Selectors of faces as a case file has them."""

from __future__ import annotations

import pytest

from castx.case.cad.selectors import FaceSelector, box, unit_vector
from castx.errors import CaseError
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial


def test_units_and_directions():
    selector = FaceSelector.read(
        {
            "normal": "-y",
            "angle": "10 deg",
            "within": [["-1 mm", 0, 0], [1, 1, 1]],
            "radius": "10 mm",
            "largest": 3,
            "body": "casting",
            "touches": "mould",
        }
    )
    assert selector.normal == (0.0, -1.0, 0.0) and selector.angle == 10.0
    assert selector.within == ((-0.001, 0.0, 0.0), (1.0, 1.0, 1.0))
    assert (selector.radius, selector.largest) == (0.01, 3)
    assert unit_vector([3, 0, 4]) == pytest.approx((0.6, 0.0, 0.8))


@pytest.mark.parametrize(
    "description, text",
    [
        ({}, "says nothing; give body, normal"),
        ({"normal": "z"}, 'normal: a direction is needed: "\\+x"'),
        ({"normal": [0, 0, 0]}, "normal: the direction has no length"),
        ({"normal": [0, 0, "a"]}, r"normal\[2\]: "),
        ({"angle": 5}, "angle: is that to `normal`, which is missing"),
        ({"radius": 0}, "radius: must be positive"),
        ({"radius": "3 s"}, "radius: 's' is not a unit of length"),
        ({"largest": 0}, "largest: a whole number from 1"),
        ({"within": [[0, 0, 0]]}, "within: a box is needed"),
        ({"within": [[0, 0, 0], [1, -1, 1]]}, r"within\[1\]\[1\]: must not be less"),
        ({"body": "a", "touches": "a"}, "touches: must be another body"),
        ({"normals": "+z"}, 'normals: unknown key.*mean "normal"'),
    ],
)
def test_refused(description, text):
    with pytest.raises(Refusal, match=text):
        FaceSelector.read(description)


def test_a_box_needs_numbers():
    with pytest.raises(CaseError, match="three numbers are needed"):
        box([[0, 0], [1, 1]])
