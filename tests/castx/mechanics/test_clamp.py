"""Clamps of single bodies: derivative of the residual, resultants and springs in every form."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.clamp import SurfaceClamp
from castx.tables import Table
from tests.castx.mechanics.lone_bodies import (
    MODELS,
    YOUNG,
    alone,
    begin_anywhere,
    check_derivative,
    jacobian_times,
    move,
)

FORMULATIONS = {
    "mixed": "simplices",
    "q1p0": "quadrilaterals",
    "displacement": "simplices",
}
formulations = pytest.mark.parametrize("formulation, cells", FORMULATIONS.items())
EVERYWHERE = [
    pytest.param(model, *kind, marks=() if model == "axisymmetric" else pytest.mark.serial)
    for model in MODELS
    for kind in FORMULATIONS.items()
    if model != "plane-stress" or kind[0] != "q1p0"  # nothing locks there
]
STIFFNESS = 3 * YOUNG * 0.01
"""Of the machine [N/m]: more than that of the body, so that no error of it hides."""
RAMP = Table.from_points([[0.0, 0.0], [10.0, 5e6]])


def surface_of(model: str) -> str:
    return "top" if model == "axisymmetric" else "far"


def clamped(comm, model, formulation, cells, stiffness=STIFFNESS, **others):
    """Return a slab clamped at one end, along the axis of the normal there."""
    clamps = [SurfaceClamp(surface_of(model), RAMP, stiffness)]
    return alone(comm, model, cells, formulation=formulation, clamps=clamps, **others)


def along(model: str) -> int:
    return 1 if model == "axisymmetric" else 0


@pytest.mark.sampled
@pytest.mark.parametrize("model, formulation, cells", EVERYWHERE)
def test_jacobian_is_the_derivative_of_the_residual(comm, model, formulation, cells):
    part = clamped(comm, model, formulation, cells)
    begin_anywhere(part)
    part.set_time(7.0)
    check_derivative(comm, part, 1.0)


@pytest.mark.ranks
@formulations
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_force_and_stiffness_are_totals(comm, model, formulation, cells):
    """A rigid motion δ against the clamp raises its resultant from F(t) by k δ, on one axis."""
    part = clamped(comm, model, formulation, cells)
    begin_anywhere(part)
    axis, size, d = along(model), part.block_size, part.dimension
    name = f"casting/{surface_of(model)}"
    plain = alone(comm, model, cells, formulation=formulation)
    begin_anywhere(plain)
    for time, moved in ((2.0, 0.0), (7.0, 3e-4), (7.0, -2e-3)):
        for body in (part, plain):
            body.set_time(time)
            values = body.solution.x.array.reshape(-1, size)
            values[:] = 0.0
            values[:, axis] = moved
        acting = (plain.residual() - part.residual()).reshape(-1, size)
        total = comm.allreduce(acting.sum(axis=0))
        force = 5e5 * time + STIFFNESS * moved
        expected = np.zeros(size)
        expected[axis] = -force
        np.testing.assert_allclose(total, expected, atol=1e-9 * STIFFNESS * 2e-3)
        (clamp,) = part.loads.clamps
        totals = clamp.totals(part.solution.x.array.reshape(-1, size)[:, :d])
        assert totals[f"{name}.clamp_force"] == pytest.approx(force, rel=1e-12)
        assert totals[f"{name}.clamp_displacement"] == pytest.approx(moved, rel=1e-12)
        springs = part.formulation.forms.spring_forces().reshape(-1, size)
        sums = comm.allreduce(springs.sum(axis=0))
        assert sums[axis] == pytest.approx(STIFFNESS * moved, abs=1e-9 * STIFFNESS * 2e-3)


@pytest.mark.ranks
@formulations
def test_springs_work_by_the_motion_of_the_surface(comm, formulation, cells):
    """A strain ε_xx moves the end by ε L; Jacobian and residual take k (ε L) there."""
    part, plain = (clamped(comm, "plane-strain", formulation, cells, k) for k in (STIFFNESS, 0.0))
    begin_anywhere(part)
    begin_anywhere(plain)
    move(part, 1e-3 * np.eye(3))
    motion = part.solution.x.array.copy()
    work = [jacobian_times(body, motion) @ motion[: body.unknowns.owned] for body in (part, plain)]
    expected = STIFFNESS * (1e-3 * 0.02) ** 2
    assert comm.allreduce(float(work[0] - work[1])) == pytest.approx(expected, rel=1e-6)


def test_a_motion_strains_the_springs_along_the_clamp(comm):
    """Tilting and moving back do, sliding along the surface does not; without stiffness nothing."""
    part = clamped(comm, "plane-strain", "displacement", "simplices")
    points = part.mesh.points[: part.owned_nodes]
    back, slide = np.zeros_like(points), np.zeros_like(points)
    back[:, 0] = slide[:, 1] = 1.0
    tilt = np.stack((-points[:, 1], points[:, 0]), axis=1)
    here = points[:, 0] > 0.0199
    np.testing.assert_allclose(part.loads.held(back), -1.0)
    np.testing.assert_array_equal(part.loads.held(slide), 0.0)
    found, expected = part.loads.held(tilt), points[here][:, 1]
    np.testing.assert_allclose(np.sort(found), np.sort(expected), atol=1e-15)
    dead = clamped(comm, "plane-strain", "displacement", "simplices", 0.0)
    assert dead.loads.backing is None and len(dead.loads.held(back)) == 0
    assert not dead.formulation.forms.spring_forces().any()


@pytest.mark.ranks
@formulations
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_a_frame_holds_in_all_directions(comm, model, formulation, cells):
    """A rigid motion of (3, 4) along two axes is resisted by five times the stiffness, along it."""
    name = surface_of(model)
    frame = SurfaceClamp(name, Table.constant(0.0), STIFFNESS, frame=True)
    held, plain = (
        alone(comm, model, cells, formulation=formulation, clamps=clamps)
        for clamps in ([frame], [])
    )
    d = held.dimension
    motion = np.zeros(held.block_size)
    motion[[along(model), d - 1 - along(model) * (d - 1)]] = 4e-4, 3e-4
    for body in (held, plain):
        begin_anywhere(body)
        body.solution.x.array.reshape(-1, body.block_size)[:] = motion
    acting = (plain.residual() - held.residual()).reshape(-1, held.block_size)
    total = comm.allreduce(acting.sum(axis=0))
    if model != "axisymmetric":  # radial forces cancel over the turn
        np.testing.assert_allclose(total, -STIFFNESS * motion, atol=1e-9 * STIFFNESS * 5e-4)
    assert total[along(model)] == pytest.approx(-STIFFNESS * 4e-4, rel=1e-9)
    (clamp,) = held.loads.clamps
    values = held.solution.x.array.reshape(-1, held.block_size)[:, :d]
    totals = clamp.totals(values)
    assert totals[f"casting/{name}.clamp_force"] == pytest.approx(STIFFNESS * 5e-4, rel=1e-12)
    assert totals[f"casting/{name}.clamp_displacement"] == pytest.approx(5e-4, rel=1e-12)
    moved = np.tile(motion[:d], (held.owned_nodes, 1))
    found = held.loads.held(moved).reshape(-1, d)
    np.testing.assert_allclose(found, np.tile(motion[:d], (len(found), 1)))
