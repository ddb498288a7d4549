"""Selectors of single faces: of a block with a bore in a mould, by hand."""

import numpy as np
import pytest

from castx.app.selectors import box_of, chosen, proposed, surfaces_of
from castx.errors import CaseError
from castx.meshes.cad.faces import Face

pytestmark = pytest.mark.serial


def flat(tag, normal, low, high, area=1.0, bodies=("part",)):
    points = np.array([low, high, 0.5 * (np.array(low) + np.array(high))])
    normals = np.tile(np.array(normal) / np.linalg.norm(normal), (3, 1))
    return Face(tag, bodies, area, points[2], points, normals, None)


def round_(tag, radius):
    points = np.array([[0.01, 0, 0], [-0.01, 0, 0.1]])
    return Face(
        tag, ("part",), 0.5, points.mean(axis=0), points, np.array([[1, 0, 0], [-1, 0, 0]]), radius
    )


FACES = [
    flat(11, [0, 0, 1], [0, 0, 0.1], [0.2, 0.1, 0.1], area=2.0),
    flat(12, [0, 0, 1], [0, 0, 0.05], [0.01, 0.01, 0.05]),
    flat(13, [0, 0, 1], [0.1, 0, 0.03], [0.11, 0.01, 0.03]),
    flat(14, [0, 0, -1], [0, 0, 0], [0.2, 0.1, 0]),
    flat(15, [1, 0, 1], [0, 0, 0], [0.1, 0.1, 0.1]),
    round_(16, 0.01),
]


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (0, {"normal": "+z", "largest": 1}),
        (1, {"normal": "+z", "within": [[0.0, 0.0, 0.05], [0.01, 0.01, 0.05]]}),
        (3, {"normal": "-z"}),
        (4, {"normal": [0.707107, 0.0, 0.707107]}),
        (5, {"radius": 0.01}),
    ],
)
def test_a_face_is_chosen_by_few_words(number, words):
    assert proposed(number, FACES) == words
    assert chosen(words, FACES) == [number]


def test_bodies_are_named_where_there_are_several():
    faces = [*FACES, flat(21, [0, 0, -1], [0, 0, -1], [1, 1, -1], bodies=("mould",)),
             flat(22, [0, 1, 0], [0, 0.1, 0], [1, 0.1, 1], bodies=("part", "mould"))]  # fmt: skip
    assert proposed(3, faces) == {"body": "part", "normal": "-z"}
    shared = proposed(7, faces)
    assert shared == {"body": "part", "touches": "mould", "normal": "+y"}
    assert chosen(shared, faces) == [7]


def test_boxes_are_rounded_outwards():
    assert box_of(np.array([[0.00011, -0.00011, 0.0002]]), 1e-4) == [
        [0.0001, -0.0002, 0.0002], [0.0002, -0.0001, 0.0002]
    ]  # fmt: skip


def test_surfaces_of_a_case_and_those_that_find_nothing():
    selectors = {"up": {"normal": "+z"}, "none": {"radius": 3.0}, "wrong": {"colour": "red"}}
    named, wrong = surfaces_of(selectors, {"symmetry-z": [3]}, FACES)
    assert named == {"symmetry-z": [3], "up": [0, 1, 2]}
    assert "selects no face" in wrong["none"] and "unknown key" in wrong["wrong"]
    with pytest.raises(CaseError):
        chosen({}, FACES)
