"""Sizes at places as a case file has them."""

from __future__ import annotations

import pytest

from castx.case.cad.sizes import LocalSize
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial


def test_sizes_have_units():
    local = LocalSize.read({"size": "2 mm", "within": [[0, 0, 0], ["1 cm", 1, 1]]})
    assert (local.size, local.within) == (0.002, ((0.0, 0.0, 0.0), (0.01, 1.0, 1.0)))
    assert LocalSize.read({"size": 1, "surface": "top"}).surface == "top"


@pytest.mark.parametrize(
    "description, text",
    [
        ({"size": 1}, "give one of body, surface and within"),
        ({"size": 1, "body": "a", "surface": "b"}, "give one of body, surface and within"),
        ({"body": "a"}, "size: missing"),
        ({"body": "a", "size": 0}, "size: must be positive"),
    ],
)
def test_refused(description, text):
    with pytest.raises(Refusal, match=text):
        LocalSize.read(description)
