"""What the melt of a mush holds at a wall, on a slab whose solid fraction falls along it."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from tests.castx.mechanics.lone_bodies import LENGTH, random_field
from tests.castx.mechanics.test_darcy import METAL, freeze, mushy

pytestmark = pytest.mark.sampled


def fractions(part, more: float) -> np.ndarray:
    x = part.mesh.points[: part.owned_nodes, 0] / LENGTH
    return np.clip(1.2 - 1.3 * x + more, 0.0, 1.0)


def test_melt_holds_until_all_is_solid_or_a_void_is_open(comm):
    """Δp_c of 1e5 Pa where f < 1 at the end of the step and no pore is open at its start."""
    part = mushy(comm)
    melt, liquid = part.formulation.wall_melt, fractions(part, 0.1) < 1.0
    np.testing.assert_array_equal(melt.pulls(), np.where(liquid, 1e5, 0.0))
    part.solution.x.array[:] = 1e-3 * random_field(part, 0.7)
    part.improve_pressures()
    opened = part.formulation._pores.open.copy()
    assert comm.allreduce(bool((opened & liquid).any()), MPI.LOR)
    np.testing.assert_array_equal(melt.pulls(), np.where(liquid, 1e5, 0.0))
    part.residual()
    part.commit()
    freeze(part, 0.1)
    np.testing.assert_array_equal(melt.pulls(), np.where(liquid & ~opened, 1e5, 0.0))


def test_the_last_melt_goes(comm):
    """Of the cube root of min(1, g/0.02): nothing changes where g > 0.02 or all was solid."""
    part, g_c = mushy(comm), 1.0 - METAL.coalescence
    freeze(part, 0.12)
    before, after = (
        np.cbrt(np.minimum(1.0, (1.0 - fractions(part, m)) / g_c)) for m in (0.0, 0.12)
    )
    lost = part.formulation.wall_melt.lost()
    np.testing.assert_allclose(lost, before - after, atol=1e-12)
    assert comm.allreduce(float(lost.max(initial=0.0)), MPI.MAX) > 0.3
