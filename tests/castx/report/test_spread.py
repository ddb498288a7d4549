"""Bodies that are drawn apart: none hides another, and each goes where it came from."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest

from castx.report.spread import shifts

pytestmark = pytest.mark.serial

FRONT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
RIGHT = np.array([1.0, -0.45, 0.0]) / np.hypot(1.0, 0.45)
EYE = np.cross([0.0, 0.0, 1.0], RIGHT) * -0.8 + np.array([0.0, 0.0, 0.6])
OBLIQUE = np.stack([RIGHT, np.cross(EYE, RIGHT)])
WAYS = np.concatenate([np.eye(3)[::-1], -np.eye(3)[::-1]])


def box(low, high):
    return np.array(list(product(*zip(low, high, strict=True))), dtype=float)


def rectangles(bodies, screen):
    moved = shifts(bodies, screen, WAYS)
    places = [(own + shift) @ screen.T for own, shift in zip(bodies, moved, strict=True)]
    return [(own.min(axis=0), own.max(axis=0)) for own in places]


@pytest.mark.parametrize("screen", [FRONT, OBLIQUE])
@pytest.mark.parametrize("seed", range(6))
def test_no_body_hides_another_wherever_they_lie(screen, seed):
    random = np.random.default_rng(seed)
    bodies = []
    for _ in range(int(random.integers(2, 7))):
        low = random.uniform(-1.0, 1.0, 3)
        bodies.append(box(low, low + random.uniform(0.05, 2.0, 3)))
    for (low, high), (other_low, other_high) in combinations(rectangles(bodies, screen), 2):
        apart = np.maximum(low - other_high, other_low - high)
        assert apart.max() > 0.05


def test_the_largest_stays_and_a_lid_goes_up():
    mould, lid, core = box([0, 0, 0], [4, 4, 4]), box([1, 1, 4], [3, 3, 5]), box([1] * 3, [3] * 3)
    moved = shifts([lid, mould, core], FRONT, WAYS)
    assert (moved[1] == 0.0).all()
    assert moved[0][2] > 0.0 and (moved[0][:2] == 0.0).all()
    assert np.linalg.norm(moved[2]) > 2.0  # out of the mould that encloses it
    assert (shifts([mould], FRONT, WAYS) == 0.0).all()
