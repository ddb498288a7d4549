"""Extremes of a stress that grows along an axis, and its mean over the volume."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.foundry.stress.stresses import StressExtremes
from tests.castx.fakes import cylinder_mesh


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_uniaxial_stress_and_shear(comm, model):
    """σ = c z along the axis: von Mises c z, mean c H/2; pure shear τ: ± τ and √3 τ."""
    body = cylinder_mesh(comm, model, 6e-3).bodies["casting"]
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    middles = body.points[body.nodes.dofmap.list[:owned]].mean(axis=1)
    stress = np.zeros((owned, 6))
    axial = 1 if model == "axisymmetric" else 2
    stress[:, axial] = 1e9 * middles[:, -1]
    found = StressExtremes(body, model).of(stress)
    top = comm.allreduce(float(middles[:, -1].max(initial=0.0)), op=max)
    assert found["largest_principal"]["value"] == pytest.approx(1e9 * top, rel=1e-12)
    assert found["largest_principal"]["place"][-1] == pytest.approx(top, rel=1e-9)
    assert found["von_mises"]["value"] == pytest.approx(1e9 * top, rel=1e-12)
    assert found["smallest_principal"]["value"] == pytest.approx(0.0, abs=1e-3)
    assert found["mean_von_mises"] == pytest.approx(1e9 * 0.02, rel=2e-2)
    stress[:] = 0.0
    stress[:, 3] = 4e7
    shear = StressExtremes(body, model).of(stress)
    assert shear["largest_principal"]["value"] == pytest.approx(4e7, rel=1e-12)
    assert shear["smallest_principal"]["value"] == pytest.approx(-4e7, rel=1e-12)
    assert shear["mean_von_mises"] == pytest.approx(math.sqrt(3.0) * 4e7, rel=1e-12)
