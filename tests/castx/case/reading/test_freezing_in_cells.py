"""Which metals freeze inside cells, and what is said of the others."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.input.problems import RefusedFile
from tests.coupled_cases import cylinder


def read(material: str, **more):
    data = cylinder()
    data["bodies"][0] |= {"material": material, "freezing": "cells", **more}
    return read_case(data, Path("case.toml"))


def test_alloys_that_freeze_over_a_range():
    for material in ("AlSi7Mg", "AlSi9Cu3", "GJL-250", "G20Mn5", "CuSn12"):
        assert read(material).bodies[0].freezing == "cells"


@pytest.mark.parametrize(
    ("material", "more", "text"),
    [
        ("Al-pure", {}, "freezes at one temperature, if only in part"),
        ("AlCu4.5", {}, "freezes at one temperature, if only in part"),
        ("insulation-fibre", {}, "never freezes"),
        ("AlSi7Mg", {"feeding": "darcy"}, 'feeding = "darcy" counts at nodes'),
    ],
)
def test_what_has_no_fraction_of_its_own_at_each_temperature_is_refused(material, more, text):
    with pytest.raises(RefusedFile, match=text):
        read(material, **more)


def test_walls_that_take_one_temperature_at_once_are_refused():
    data = cylinder({"interfaces": [{"bodies": ["casting", "mould"], "heat": {"law": "perfect"}}]})
    data["bodies"][0] |= {"material": "AlSi7Mg", "freezing": "cells"}
    with pytest.raises(RefusedFile, match=r"bodies\[0\]\.freezing.*perfect contact.*nodes"):
        read_case(data, Path("case.toml"))
