"""V12: stress in a slab that solidifies from a chilled wall, free to contract but not to bend.

Reference and its source: `castx/proof/verification/solids/solidifying_slab.py`.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.proof.verification.solids.solidifying_slab import (
    FORMULATIONS,
    OTHER,
    STEEL,
    Found,
    Slab,
    bin_means,
    slab_case,
    solve,
    stepped,
)
from tests.coupled_cases import merged
from tests.verification.solidifying_slab import check, run


def case(
    slab: Slab, model: str, cells: str, *, resolution: int, step: float, end: float, **body: Any
) -> dict[str, Any]:
    """Return the case in equal steps, solved directly and to a tight tolerance."""
    made = slab_case(slab, model, cells, resolution=resolution, end=end, **body)
    return merged(stepped(made, step), {"output": {"every": 1.0}})


@cache
def steel_slab(kind: str, resolution: int, step: float) -> Found:
    """Return what a slab of steel has after 10 s."""
    data = case(STEEL, *FORMULATIONS[kind], resolution=resolution, step=step, end=10.0)
    return run(MPI.COMM_SELF, data, STEEL)


@pytest.mark.slow
@pytest.mark.serial  # long; a coarse run compares ranks
@pytest.mark.parametrize("kind", FORMULATIONS)
def test_stress_and_strain(kind):
    step = 0.2 if kind == "tetrahedra" else 0.1
    check(steel_slab(kind, 60, step), solve(STEEL), 60, (1.0, 10.0))


@pytest.mark.slow
@pytest.mark.serial
def test_another_slab(comm):
    data = case(OTHER, *FORMULATIONS["triangles"], resolution=30, step=0.05, end=4.0)
    check(run(comm, data, OTHER), solve(OTHER), 30, (1.0, 4.0))


@pytest.mark.ranks
@pytest.mark.parametrize("kind", ["triangles", "hexahedra"])
def test_ranks_agree(comm, kind):
    data = case(OTHER, *FORMULATIONS[kind], resolution=8, step=0.5, end=3.0)
    data = merged(data, {"solver": {"mechanics_tolerance": 1e-11, "heat_tolerance": 1e-12}})
    found = [run(each, data, OTHER) for each in (comm, MPI.COMM_SELF)]
    stresses = []
    for one in found:
        order = np.lexsort((one.stress[:, 1].round(-1), one.volumes.round(14), one.xi.round(9)))
        stresses.append(one.stress[order])
    np.testing.assert_allclose(*stresses, atol=1e-6 * OTHER.yield_at_wall)
    assert found[0].strain == pytest.approx(found[1].strain, rel=1e-7)


@pytest.mark.slow
@pytest.mark.serial
def test_the_error_falls_with_mesh_and_step():
    """In the mean: beside the place where the metal begins to flow its stress has a kink.

    The cell that holds the kink makes the error of one mesh smaller or larger by a third.
    """
    exact = solve(STEEL)
    errors = []
    for resolution, step in ((15, 0.4), (60, 0.1)):
        means = bin_means(steel_slab("triangles", resolution, step), resolution)
        solid = means.xi < 1.0
        error = means.stress[:, 0] - exact.stress(means.xi)
        errors.append(np.mean(np.abs(error[solid])))
    assert errors[0] > 1.6**2 * errors[1]


@pytest.mark.serial
def test_perfect_plasticity_is_the_limit_of_viscous_flow(comm):
    """A Bingham solid of low viscosity has the same stress, one of high viscosity bears more."""
    peaks = []
    for change in (
        {},
        {"law": "bingham", "viscosity": 1e6},
        {"law": "bingham", "viscosity": 1e10},
    ):
        law = "thermo-elasto-viscoplastic" if change else "thermo-elasto-plastic"
        data = case(
            STEEL, *FORMULATIONS["quadrilaterals"], resolution=15, step=0.2, end=4.0, law=law
        )
        data = merged(data, {"materials": {"metal": change}})
        peaks.append(run(comm, data, STEEL).stress.max())
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-2)
    assert peaks[2] > 1.2 * peaks[0]
