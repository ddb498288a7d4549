"""A strip of two rings: its volumes, its surfaces and its common nodes."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.proof.foreign.rings import draw_rings
from castx.proof.verification.states import drawn_mesh

RADII = (0.95, 1.05, 1.15)


@pytest.mark.ranks
def test_rings_share_their_nodes_and_fill_the_strip(comm):
    def draw():
        draw_rings(("inside", "outside"), RADII, (4, 3), 0.02)

    with drawn_mesh(comm, draw) as folder:
        geometry = {"file": folder / "mesh.msh", "model": "axisymmetric"}
        mesh = build_mesh(Geometry.model_validate(geometry), ["inside", "outside"], comm)
    for name, cells, low, high in (("inside", 4, 0.95, 1.05), ("outside", 3, 1.05, 1.15)):
        body = mesh.bodies[name]
        assert comm.allreduce(body.cell_numbering.owned) == cells
        r = np.concatenate(comm.allgather(body.points[:, 0]))
        assert (r.min(), r.max()) == (pytest.approx(low), pytest.approx(high))
        assert {"bottom", "top"} <= set(body.surfaces)
    assert "inner" in mesh.bodies["inside"].surfaces and "outer" in mesh.bodies["outside"].surfaces
    shared = mesh.bodies["inside"].surface_nodes("outside")
    owned = shared[shared < mesh.bodies["inside"].nodes.dofmap.index_map.size_local]
    assert comm.allreduce(len(owned)) == 2
