"""What V12 demands of a run, as `castx/proof/verification/solids/solidifying_slab.py` has it."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import pytest
from scipy.optimize import brentq

from castx.proof.verification.solids.solidifying_slab import (
    Found,
    Slab,
    Solution,
    bin_means,
    follow,
)
from tests import coupled_cases


def run(comm: MPI.Intracomm, data: dict[str, Any], slab: Slab) -> Found:
    """Run a case and return what it gives."""
    return follow(coupled_cases.simulation(comm, data), data, slab)


def check(found: Found, exact: Solution, resolution: int, times: tuple[float, float]) -> None:
    scale = exact.slab.yield_at_wall
    means = bin_means(found, resolution)
    away = np.abs(means.xi - 1.0) > 2.0 / resolution
    for lateral in means.stress.T:
        assert np.abs(lateral - exact.stress(means.xi))[away].max() < 0.05 * scale
    assert np.abs(means.along[away]).max() < 0.01 * scale
    change = found.strain[times[1]] - found.strain[times[0]]
    expected = exact.rate * 0.5 * np.log(times[1] / times[0])
    assert change == pytest.approx(expected, rel=0.03)
    # The force on the lateral face, per Y_w X of the solid.
    force = found.volumes @ found.stress[:, 0] / found.volumes[found.xi < 1.0].sum()
    assert abs(force) < 1e-3 * scale
    assert found.cutbacks == 0
    sign = means.xi[means.stress[:, 0] > 0].min()
    assert sign == pytest.approx(brentq(exact.elastic, exact.compression, exact.tension), abs=0.02)
