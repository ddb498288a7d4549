"""The exploded view shows each body, surface and interface in its colour, with a legend."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from castx.errors import CaseError
from castx.report.exploded import DOTS_PER_INCH, LINE, Mark, colours, paints, write_picture
from castx.report.shells import Shell

pytestmark = pytest.mark.serial

SIDES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]


def box(low, high):
    """Return the sides of a box (6, 4, 3), those across x first, z and y next."""
    corners = np.array(list(product(*zip(low, high, strict=True))), dtype=float)
    return corners[np.array(SIDES)]


def nested():
    """Return a core in a casting in a mould, which hide each other unless they are moved."""
    core, hole = box([4, 4, 4], [6, 6, 6]), box([4, 4, 4], [6, 6, 6])
    casting, cavity = box([2, 2, 2], [8, 8, 8]), box([2, 2, 2], [8, 8, 8])
    block = box([0, 0, 0], [10, 10, 10])
    return [
        Shell("core", core, {"casting/core": core}),
        Shell("casting", np.concatenate([casting, hole]),
              {"casting/core": hole, "casting/top": casting[5:], "casting/mould": casting[:5]}),
        Shell("mould", np.concatenate([block, cavity]),
              {"casting/mould": cavity[:5], "mould/back": block[:1], "mould/outside": block[1:]}),
    ]  # fmt: skip


def shares(file: Path, wanted: dict[str, str], side: slice) -> dict[str, float]:
    """Return the share of the pixels with the hue of each colour on a side, without the legend."""
    picture = imread(file)[:, :, :3]
    height, width = picture.shape[:2]
    picture = picture[: int(0.85 * height), side.start * width // 2 : side.stop * width // 2]
    found = {}
    for name, colour in wanted.items():
        rgb = np.array(to_rgb(colour))
        hue = rgb / np.linalg.norm(rgb)
        along = picture @ hue
        away = np.linalg.norm(picture - along[..., None] * hue, axis=2)
        lit = np.abs(along / np.linalg.norm(rgb) - 0.85) < 0.25
        found[name] = float(((away < 0.03 * along) & lit).mean())
    return found


def line_shares(file: Path, wanted: dict[str, str], side: slice) -> dict[str, float]:
    """Return the share of a side that lines of each colour cover, without the legend.

    Lines are two or three pixels wide, and shrinking a picture mixes them with the grey and white
    beside them, in each version of matplotlib in another way. Neither changes where a colour stands
    on the wheel of colours, nor how much of it there is in all.
    """
    picture = imread(file)[:, :, :3]
    height, width = picture.shape[:2]
    picture = picture[: int(0.85 * height), side.start * width // 2 : side.stop * width // 2]
    chroma = picture - picture.mean(axis=2, keepdims=True)
    found = {}
    for name, colour in wanted.items():
        pure = np.array(to_rgb(colour)) - np.mean(to_rgb(colour))
        along = chroma @ pure / (pure @ pure)
        away = np.linalg.norm(chroma - along[..., None] * pure, axis=2)
        alike = (along > 0.2) & (away < 0.2 * along * np.linalg.norm(pure))
        found[name] = float(np.where(alike, along, 0.0).mean())
    return found


def test_every_body_surface_and_interface_is_seen(tmp_path):
    shells = nested()
    write_picture(shells, False, tmp_path / "parts.png")
    bodies, skins = paints(shells, False)
    assert set(bodies.colours) == {"core", "casting", "mould"}
    for name, share in shares(tmp_path / "parts.png", bodies.colours, slice(0, 1)).items():
        assert share > 0.003, name
    chosen = {name: c for name, c in skins.colours.items() if name != "mould/outside"}
    assert set(chosen) == {"casting/core", "casting/top", "casting/mould", "mould/back"}
    for name, share in shares(tmp_path / "parts.png", chosen, slice(1, 2)).items():
        assert share > 0.003, name
    mixed = shares(tmp_path / "parts.png", bodies.colours, slice(1, 2))
    assert max(mixed.values()) < 1e-3  # the two sides have nothing in common


def test_plane_bodies_are_seen_from_one_side(tmp_path):
    square = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    edges = np.stack([square[0], np.roll(square[0], -1, axis=0)], axis=1)
    aside = np.array([1.0, 0.0, 0.0])
    shells = [
        Shell("left", square, {"left/outside": edges[[0, 2, 3]], "left/right": edges[[1]]}),
        Shell("right", square + aside, {"left/right": edges[[3]] + aside}),
    ]
    write_picture(shells, True, tmp_path / "parts.png")
    bodies, skins = paints(shells, True)
    found = shares(tmp_path / "parts.png", bodies.colours, slice(0, 1))
    assert min(found.values()) > 0.2
    assert found["left"] == pytest.approx(found["right"], rel=0.02)
    lines = line_shares(tmp_path / "parts.png", skins.colours, slice(1, 2))
    assert set(lines) == {"left/right", "left/outside"} and min(lines.values()) > 1e-3
    # three sides of a square beside one of each
    assert lines["left/outside"] / lines["left/right"] == pytest.approx(3 / 2, rel=0.1)


def test_probes_are_marked_where_their_bodies_are_drawn(tmp_path):
    """Two marks in corners of a picture that shows one square: only there it is black."""
    square = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    edges = np.stack([square[0], np.roll(square[0], -1, axis=0)], axis=1)
    shells = [Shell("left", square, {"left/outside": edges})]
    file = tmp_path / "parts.png"

    def black(marks):
        write_picture(shells, True, file, [Mark("", "left", at) for at in marks])
        picture = imread(file)[:, :, :3]
        half = picture.shape[1] // 2
        places = np.argwhere(picture[60:-100, half + 40 : -40].max(axis=2) < 0.02)
        return (places / [len(picture), half])[:, ::-1]

    assert len(black([])) == 0
    low, high = black([(0.2, 0.2)]).mean(axis=0), black([(0.7, 0.6)]).mean(axis=0)
    away = (high - low) * [imread(file).shape[1] // 2, imread(file).shape[0]]
    assert away[0] > 0 > away[1]
    assert away[0] / -away[1] == pytest.approx(0.5 / 0.4, rel=0.02)
    assert len(black([(0.2, 0.2), (0.7, 0.6)])) > 1.5 * len(black([(0.7, 0.6)]))


def test_names_of_marks_do_not_cover_each_other(tmp_path):
    """The second name of one place stands a line higher."""
    file = tmp_path / "parts.png"
    heights = []
    for count in (1, 2, 3):
        write_picture(nested()[:1], True, file, [Mark("name", "core", (5.0, 5.0))] * count)
        dark = np.argwhere(imread(file)[60:-100, 500:, :3].max(axis=2) < 0.2)
        heights.append(np.ptp(dark[:, 0]))
    assert np.diff(heights) == pytest.approx(LINE / 72 * DOTS_PER_INCH, abs=2)


def test_colours_all_differ():
    for count in (3, 18, 60):
        found = np.array([to_rgb(colour) for colour in colours(count)])
        apart = np.abs(found[:, None] - found[None]).max(axis=2) + np.eye(count)
        assert len(found) == count and apart.min() > 0.01


def test_refused(tmp_path):
    with pytest.raises(CaseError, match=r"parts\.stl: the name must end in \.png, \.svg, \.pdf"):
        write_picture(nested(), False, tmp_path / "parts.stl")
    with pytest.raises(CaseError, match=r"cannot write .*nowhere/parts\.png: No such file"):
        write_picture(nested()[:1], False, tmp_path / "nowhere" / "parts.png")
