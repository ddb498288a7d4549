"""A loaded mush against Terzaghi's numbers, a difference scheme of its own and a mass balance."""

import numpy as np
import pytest

from castx.foundry.mush_column import MushResistance
from castx.foundry.porosity import Melt
from castx.foundry.skeleton import (
    consolidation,
    consolidation_coefficient,
    undrained,
)

pytestmark = pytest.mark.serial

MELT, LENGTH, LOAD, SHEAR = Melt(1e-3, 0.06), 10e-3, 1e4, 1e6
TIMES = np.array([0.4374, 2.187, 4.374])


def coefficient():
    permeability = MushResistance(MELT, 50e-6, 0.02).permeability(np.array(0.1))
    return consolidation_coefficient(float(permeability), MELT.viscosity, SHEAR)


def test_consolidation_of_a_mush_at_nine_tenths():
    assert coefficient() == pytest.approx(2.286237e-5, rel=1e-6)
    settlement, base = consolidation(TIMES, LENGTH, LOAD, SHEAR, coefficient())
    np.testing.assert_allclose(settlement, [26.76176e-6, 57.29627e-6, 69.84448e-6], rtol=1e-6)
    np.testing.assert_allclose(base, [9493.054, 3707.774, 1079.770], rtol=1e-6)


def implicit(cells, steps):
    """Return settlement and base pressure at the last of the times, by implicit differences."""
    size, step = LENGTH / cells, TIMES[-1] / steps
    pressure = np.full(cells, LOAD)
    share = coefficient() * step / size**2
    matrix = np.diag(np.full(cells, 1.0 + 2.0 * share))
    matrix += np.diag(np.full(cells - 1, -share), 1) + np.diag(np.full(cells - 1, -share), -1)
    matrix[0, 0] -= share
    matrix[-1, -1] += share
    for _ in range(steps):
        pressure = np.linalg.solve(matrix, pressure)
    lost = (LOAD - pressure).sum() * size / (4.0 * SHEAR / 3.0)
    return lost, 1.5 * pressure[0] - 0.5 * pressure[1]


def test_a_difference_scheme_tends_to_it():
    settlement, base = consolidation(TIMES[-1:], LENGTH, LOAD, SHEAR, coefficient())
    errors = []
    for cells, steps in ((20, 80), (40, 160)):
        found = implicit(cells, steps)
        errors.append(np.abs([found[0] / settlement[0] - 1.0, found[1] / base[0] - 1.0]))
    assert errors[1][0] < 0.01 and errors[1][1] < 0.02
    assert np.all(errors[0] > 1.8 * errors[1])


def test_undrained_freezing():
    strain, pressure = undrained(0.8, 0.9, 0.06, SHEAR)
    assert strain == pytest.approx(-5.692600e-3, rel=1e-6)
    assert pressure == pytest.approx(-7590.133, rel=1e-6)
