"""What the mesher is asked for is what the case says."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from castx.case.cad.geometry import CadGeometry
from castx.domain.cad.description import part_of
from castx.domain.cad.size_map import write_size_map
from castx.meshes.cad.description import (
    CadFile,
    CadPart,
    Channel,
    Chill,
    Mould,
    Selector,
    SizeRule,
    SymmetryPlane,
)

pytestmark = pytest.mark.serial


def test_mould_and_symmetry_reach_the_mesher():
    line = [[0, 0, 0], [1, 0, 0]]
    mould = {
        "name": "die", "box": 2, "split": "z = 1", "cores": ["c"],
        "chills": [{"name": "k", "box": [[0, 0, 0], [1, 1, 1]]},
                   {"name": "p", "line": line, "diameter": 3}],
        "cooling": [{"line": line, "diameter": 4}],
    }  # fmt: skip
    base = {"file": "a.step", "size": 1, "symmetry": ["y < 2"]}
    part = part_of(CadGeometry.read({**base, "mould": mould}), None)
    ends = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    assert part.symmetry == (SymmetryPlane(1, 2.0, above=False),)
    assert part.mould == Mould(
        "die", 2.0, None, (2, 1.0), ("c",),
        (Chill("k", ((0, 0, 0), (1, 1, 1))), Chill("p", None, ends, 3.0)),
        (Channel("cooling", ends, 4.0),),
    )  # fmt: skip
    shell = CadGeometry.read({**base, "mould": {"shell": "8 mm"}})
    assert part_of(shell, None).mould == Mould(shell=0.008)
    boxed = CadGeometry.read({**base, "mould": {"box": [[0, 0, 0], [1, 1, 1]]}})
    assert part_of(boxed, None).mould == Mould("mould", 0.0, ((0, 0, 0), (1, 1, 1)))


def test_every_key_reaches_the_mesher():
    selector = {
        "body": "a", "normal": "+x", "angle": 5, "within": [[0, 0, 0], [1, 1, 1]], "touches": "b",
        "radius": 2, "largest": 4,
    }  # fmt: skip
    cad = CadGeometry.read(
        {"parts": {"a": "a.brep"}, "unit": "cm", "size": 3, "tolerance": 0.5, "narrowest": 0.2,
         "names": {"L": "b"},
         "curvature": 20, "across": 3, "interface_size": 2, "growth": 0.7, "most_cells": 5e4,
         "sizes": [{"size": 1, "body": "a"}, {"size": 2, "surface": "s"},
                   {"size": 1, "within": [[0, 0, 0], [1, 1, 1]]}],
         "surfaces": {"s": selector}}
    )  # fmt: skip
    part = part_of(cad, ["a", "b"])
    assert part.files == (CadFile("a.brep", "a", pytest.approx(0.01)),)
    assert (part.bodies, part.names) == (("a", "b"), {"L": "b"})
    assert (part.size, part.tolerance, part.curvature) == (3.0, 0.5, 20.0)
    assert part.narrowest == 0.2
    assert part.selectors == (
        Selector("s", "a", (1.0, 0.0, 0.0), radians(5), ((0, 0, 0), (1, 1, 1)), "b", 2.0, 4, 0.5),
    )
    assert (part.across, part.interface_size, part.growth, part.most_cells) == (3, 2.0, 0.7, 5e4)
    assert part.rules == (
        SizeRule(1.0, body="a"),
        SizeRule(2.0, surface="s"),
        SizeRule(1.0, within=((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))),
    )
    assert part.size_map is None
    assert part_of(cad, None).bodies is None


def test_sizes_over_space_are_read_and_refined(tmp_path):
    points, file = np.vstack([np.zeros(3), np.eye(3)]), tmp_path / "sizes.vtu"
    write_size_map(file, points, np.array([[0, 1, 2, 3]]), np.array([1.0, 2.0, 3.0, 4.0]))
    given = {"file": "a.step", "size": 6, "size_map": str(file), "refinement": 2}
    size_map = part_of(CadGeometry.read(given), None).size_map
    assert size_map.sizes.tolist() == [[0.5, 1.0, 1.5, 2.0]]
    np.testing.assert_array_equal(size_map.corners, [points])


def test_refinement_divides_every_size():
    given = {"file": "a.step", "size": 6, "interface_size": 4, "sizes": [{"size": 2, "body": "a"}]}
    part = part_of(CadGeometry.read({**given, "refinement": 2}), None)
    assert (part.size, part.interface_size, part.rules[0].size) == (3.0, 2.0, 1.0)
    plain = CadPart(part.files, 1.0)
    finer = part.curvature / plain.curvature, part.across / plain.across, plain.growth / part.growth
    assert finer == (2.0, 2.0, 2.0)
    assert part_of(CadGeometry.read({"file": "a.step", "size": 6}), None).interface_size is None
