"""Mean permeability of cells over a step against sums over many points."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.mush_column import MushResistance
from castx.foundry.porosity import Melt
from castx.mechanics.mush.permeability import step_permeability

pytestmark = pytest.mark.serial

MUSH = MushResistance(Melt(1e-3, 0.06), 50e-6, 0.02, 0.05)


def summed(start: list[float], end: list[float], points: int = 2000) -> float:
    """Return ⟨g⟩/⟨g/K⟩ by the rule of the middle points."""
    at = (np.arange(points) + 0.5) / points
    low = min(start) + at * (min(end) - min(start))
    high = max(start) + at * (max(end) - max(start))
    g = low[:, None] + at * (high - low)[:, None]
    x = np.maximum(g, 0.02)
    permeability = (50e-6) ** 2 * x**3 / (180 * np.maximum(1 - x, 0.05) ** 2)
    return g.mean() / (g / permeability).mean()


@pytest.mark.parametrize(
    ("start", "end"),
    [
        ([0.4, 0.4], [0.4, 0.4]),
        ([0.3, 0.5], [0.25, 0.45]),
        ([0.3, 0.31, 0.5], [0.0, 0.1, 0.2]),
        ([0.9, 1.0], [0.85, 1.0]),
        ([0.05, 0.05], [0.0, 0.01]),
        ([1.0, 1.0, 1.0, 1.0], [1.0, 0.9, 1.0, 1.0]),
    ],
)
def test_mean_over_cell_and_step(start, end):
    found = step_permeability(MUSH, np.array([start]), np.array([end]))
    assert found[0] == pytest.approx(summed(start, end), rel=2e-3)


def test_cells_with_a_solid_corner_let_nothing_through():
    start = np.array([[0.0, 0.5], [0.5, 0.5], [0.2, 0.0]])
    found = step_permeability(MUSH, start, np.full((3, 2), 0.4))
    assert (found > 0.0).tolist() == [False, True, False]


def test_even_freezing_has_exact_pressures_at_the_nodes_of_any_mesh():
    """Falls of ∫ g/K dx for a flow that grows with g, whatever the elements."""
    nodes = np.array([0.02, 0.05, 0.3, 0.8, 1.0])
    cells = np.column_stack([nodes[:-1], nodes[1:]])
    found = (np.diff(nodes) * cells.mean(axis=1) / step_permeability(MUSH, cells, cells)).sum()
    fine = np.linspace(0.02, 1.0, 200_001)
    middle = 0.5 * (fine[1:] + fine[:-1])
    exact = (middle / MUSH.permeability(middle)).mean() * 0.98
    assert found == pytest.approx(exact, rel=1e-6)
