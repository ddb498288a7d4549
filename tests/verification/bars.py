"""The stress of a bar in uniaxial stress, run as a case file describes it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from tests import coupled_cases


def stresses(comm: MPI.Intracomm, case: Mapping[str, Any]) -> FloatArray:
    """Run a bar and return the stress along it after each step [Pa]; all others must be zero."""
    found = []
    axis = 1 if case["geometry"]["model"] == "axisymmetric" else 0
    for state in coupled_cases.states(comm, case):
        assert state.counters.cutbacks == 0
        if state.step > 0:
            stress = np.concatenate(comm.allgather(state.cellwise("casting", "stress")))
            along = stress[:, axis].copy()
            stress[:, axis] = 0.0
            np.testing.assert_allclose(along, along[0], rtol=1e-7)
            assert np.abs(stress).max() < 1e-7 * np.abs(along).max()
            found.append(along[0])
    return np.array(found)
