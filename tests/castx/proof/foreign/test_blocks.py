"""Two blocks side by side: their cells, their surfaces, and nodes of their own."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.proof.foreign.blocks import draw_blocks
from castx.proof.verification.states import drawn_mesh


@pytest.mark.ranks
def test_blocks_have_nodes_and_surfaces_of_their_own(comm):
    names, edges, cells = ("left", "right"), (0.0, 1.0, 1.0, 1.5), ((4, 3), (2, 5))
    with drawn_mesh(comm, lambda: draw_blocks(names, edges, 0.5, cells)) as folder:
        geometry = {"file": folder / "mesh.msh", "model": "plane-strain"}
        mesh = build_mesh(Geometry.model_validate(geometry), names, comm)
    for number, name in enumerate(names):
        body, (across, up) = mesh.bodies[name], cells[number]
        assert comm.allreduce(body.cell_numbering.owned) == across * up
        assert {f"{name}-{side}" for side in ("left", "right", "bottom", "top")} == set(
            body.surfaces
        )
        own = body.points[: body.nodes.dofmap.index_map.size_local]
        points = np.concatenate(comm.allgather(own))
        for x in edges[2 * number : 2 * number + 2]:
            assert np.isclose(points[:, 0], x).sum() == up + 1
