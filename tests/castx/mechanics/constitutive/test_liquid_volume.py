"""What liquid lacks of its volume: kept at rest, forgotten beside growing solid and in pools."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.constitutive import liquid_volume
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Law
from tests.elastic_bodies import elastic, generated

COLUMNS, SIZE = 4, 0.005
SHARE = 0.1
"""Of solid at the nodes of the wall."""
METAL = elastic(
    60e9, 0.33, 2e-5, solidus=560.0, liquidus=610.0, latent_heat=4e5,
    liquid={"viscosity": 2e6, "coherency": 0.6},
)  # fmt: skip


def forgotten(comm, start: float, end: float, pooled: int | None = None) -> FloatArray:
    """Return what the columns of cells of a slab forget as its wall changes, shape (columns,)."""
    body = generated(
        comm, "plane-strain", "slab", ["casting"], length=COLUMNS * SIZE, width=0.01, size=SIZE,
        cells="quadrilaterals",
    ).bodies["casting"]  # fmt: skip
    points = IntegrationPoints(body, "plane-strain", 1)
    law, x = Law(METAL, 560.0), body.nodes.tabulate_dof_coordinates()[:, 0]

    def fractions(share: float) -> FloatArray:
        return np.where((x < 0.5 * SIZE) & (share > 0), 0.6 + 0.4 * share, 0.0)

    temperature = np.full(len(x), 590.0)
    before = law.nodes(temperature, fractions(start))
    conditions = law.conditions(points, temperature, fractions(end), 1.0, before)
    column = np.rint(x[points.cell_nodes].mean(axis=1) / SIZE - 0.5).astype(int)
    pool: BoolArray | None = None if pooled is None else column == pooled
    found = liquid_volume.forgotten(points, before, conditions, pool)
    return _by_column(comm, points, column, found)


def _by_column(comm, points: IntegrationPoints, column: Any, values: FloatArray) -> FloatArray:
    """Return the value that all cells of a column have, ghosts as well, shape (columns,)."""
    own = [set(values[column == number].round(12)) for number in range(COLUMNS)]
    parts = [set().union(*each) for each in zip(*comm.allgather(own), strict=True)]
    assert all(len(part) == 1 for part in parts)
    return np.array([part.pop() for part in parts])


@pytest.mark.ranks
def test_liquid_beside_growing_solid_forgets(comm, monkeypatch):
    """By k times the mean growth of the cells around: the one with the solid, and the next one."""
    usual = forgotten(comm, 0.0, SHARE)
    np.testing.assert_allclose(usual, [0.0, 9.0 * SHARE / 2, 0.0, 0.0])
    monkeypatch.setattr(liquid_volume, "FORGETTING", 6.0)
    np.testing.assert_allclose(forgotten(comm, 0.0, SHARE), usual / 1.5)
    np.testing.assert_allclose(forgotten(comm, 0.4 * SHARE, SHARE), 0.4 * usual)


def test_no_more_than_all_is_forgotten(comm):
    assert forgotten(comm, 0.0, 1.0)[1] == 1.0


@pytest.mark.parametrize(
    ("start", "end"), [(0.0, 0.0), (SHARE, SHARE), (SHARE, 0.5 * SHARE), (SHARE, 0.0)]
)
def test_nothing_is_forgotten_at_rest_or_as_solid_melts(comm, start, end):
    assert not forgotten(comm, start, end).any()


def test_a_pool_holds_the_volume_of_all_its_cells(comm):
    np.testing.assert_allclose(forgotten(comm, 0.0, SHARE, pooled=2), [0.0, 4.5 * SHARE, 1.0, 0.0])
