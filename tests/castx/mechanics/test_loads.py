"""External forces: resultants, tables over time, and closed surfaces."""

from __future__ import annotations

import numpy as np
import pytest
import ufl

from castx.mechanics.clamp import SurfaceClamp
from castx.mechanics.description import SurfaceLoad
from castx.tables import Table
from tests.castx.mechanics.lone_bodies import alone
from tests.elastic_bodies import STRESS_FREE, everywhere


@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_loads_follow_their_tables(comm, model):
    """The resultants of pressure, traction and body force are those of the surfaces."""
    growing = Table.from_points([[0.0, 0.0], [10.0, 10e6]])
    loads = (
        SurfaceLoad("far", pressure=growing),
        SurfaceLoad("far", traction=(Table.constant(0.0), growing)[: 3 if model == "3d" else 2]
                    + ((Table.constant(0.0),) if model == "3d" else ())),
    )  # fmt: skip
    part = alone(comm, model, loads=loads, body_force=(0.0, 5e6))
    nodes = len(part.mesh.parent_vertices)
    part.update_state(np.full(nodes, STRESS_FREE), np.ones(nodes), 1.0)
    area = {"plane-strain": 0.01, "axisymmetric": 2 * np.pi * 0.02 * 0.01, "3d": 1e-4}[model]
    volume = {"plane-strain": 2e-4, "axisymmetric": np.pi * 4e-4 * 0.01, "3d": 2e-6}[model]
    for time in (2.0, 7.0):
        part.set_time(time)
        force = -everywhere(comm, part.residual().reshape(-1, part.block_size)).sum(axis=0)
        assert force[0] == pytest.approx(-1e6 * time * area, rel=1e-10)
        assert force[1] == pytest.approx(1e6 * time * area + 5e6 * volume, rel=1e-10)


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_pressure_all_around_is_in_balance_with_itself(comm, model):
    """Its work on a displacement is -p̄ times the change of volume: A x has tr(A) V."""
    around = ["wall", "far", "bottom", "top", *(["back", "front"] if model == "3d" else [])]
    part = alone(comm, model, loads=[SurfaceLoad(s, Table.constant(2e6)) for s in around])
    part.set_time(0.0)
    d = part.dimension
    forces = part.formulation.forms.load.reshape(-1, part.block_size)[:, :d]
    points = part.mesh.points[: len(forces)]
    moments = comm.allreduce(forces.T @ points)
    volume = {"plane-strain": 2e-4, "3d": 2e-6}[model]
    np.testing.assert_allclose(moments, -2e6 * volume * np.eye(d), atol=1e-9 * 2e6 * volume)
    np.testing.assert_allclose(comm.allreduce(forces.sum(axis=0)), 0.0, atol=1e-9 * 2e6 * volume)


def test_one_form_serves_loads_and_clamps_of_any_sides(comm):
    """A form is compiled for the numbers of its surfaces, which meshes give as they like."""
    signatures = set()
    for loaded, clamped in (("far", "top"), ("wall", "far"), ("bottom", "top")):
        loads = [SurfaceLoad(loaded, Table.constant(2e6))]
        clamps = [SurfaceClamp(clamped, Table.constant(3e3))]
        part = alone(comm, loads=loads, clamps=clamps)
        signatures.add(part.loads.virtual_work(ufl.TestFunction(part.mesh.vectors)).signature())
    assert len(signatures) == 1


def test_a_force_may_depend_on_the_position(comm):
    """The resultant of b = (0, β x) over 0 < x < L, 0 < y < W is β L² W / 2."""
    part = alone(comm, body_force=lambda x: ufl.as_vector([0.0, 8e6 * x[0]]))
    part.set_time(0.0)
    forces = part.formulation.forms.load.reshape(-1, part.block_size)
    resultant = comm.allreduce(forces.sum(axis=0))
    np.testing.assert_allclose(resultant[:2], [0.0, 8e6 * 0.02**2 * 0.01 / 2], atol=1e-9)


def test_pressures_at_rest_follow_a_uniform_body_force(comm):
    part = alone(comm, "plane-strain", body_force=(3.0, -7.0))
    assert part.loads.weighs
    points = part.mesh.points
    np.testing.assert_allclose(part.loads.potential(), 3.0 * points[:, 0] - 7.0 * points[:, 1])
    varying = alone(comm, "plane-strain", body_force=lambda x: ufl.as_vector((x[1], 0.0)))
    assert not varying.loads.weighs and not varying.loads.potential().any()
