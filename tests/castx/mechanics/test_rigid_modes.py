"""Rigid motions as unknowns: how many, how large, and free of force in every formulation."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest
from dolfinx import fem

from castx.mechanics.rigid_modes import extent, near_null_modes, rigid_modes
from tests.castx.mechanics.lone_bodies import (
    LENGTH,
    MODELS,
    WIDTH,
    YOUNG,
    alone,
    begin,
    jacobian_times,
)
from tests.elastic_bodies import STRESS_FREE

pytestmark = pytest.mark.sampled

COUNT = {"axisymmetric": 1, "3d": 6}
FORMULATIONS = {
    "mixed": "simplices",
    "displacement": "simplices",
    "q1p0": "quadrilaterals",
}


def with_ghosts(part, owned):
    """Return owned unknowns with those of ghosts behind them."""
    function = fem.Function(part.space)
    function.x.array[: len(owned)] = owned
    function.x.scatter_forward()
    return function.x.array


# ε_zz of plane stress would have to follow the mean dilatation: not offered with Q1/P0.
OFFERED = [
    (model, formulation)
    for model in MODELS
    for formulation in FORMULATIONS
    if (model, formulation) != ("plane-stress", "q1p0")
]


@pytest.mark.parametrize(("model", "formulation"), OFFERED)
def test_rigid_motions_are_in_the_null_space_of_the_jacobian(comm, model, formulation):
    part = alone(comm, model, FORMULATIONS[formulation], formulation=formulation)
    begin(part, STRESS_FREE)
    part.update_points()
    modes = rigid_modes(part.unknowns)
    assert len(modes) == COUNT.get(model, 3)
    for mode in modes:
        forces = jacobian_times(part, with_ghosts(part, mode))
        assert np.abs(forces).max(initial=0.0) < 1e-12 * YOUNG
        largest = comm.allreduce(np.abs(mode).max(initial=0.0), op=MPI.MAX)
        assert 0.1 < largest < 1.0 + 1e-12
    gram = comm.allreduce(modes @ modes.T)
    assert np.linalg.cond(gram / np.sqrt(np.outer(gram.diagonal(), gram.diagonal()))) < 10


@pytest.mark.ranks
@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
@pytest.mark.parametrize("model", MODELS)
def test_multigrid_gets_radial_translation_and_pressure_too(comm, model, formulation):
    part = alone(comm, model, formulation=formulation)
    rigid, modes = rigid_modes(part.unknowns), near_null_modes(part.unknowns)
    np.testing.assert_array_equal(modes[: len(rigid)], rigid)
    extra = [mode.reshape(-1, part.block_size) for mode in modes[len(rigid) :]]
    components = [0] if model == "axisymmetric" else []
    components += [part.dimension] if formulation == "mixed" else []
    assert len(extra) == len(components)
    for mode, component in zip(extra, components, strict=True):
        np.testing.assert_array_equal(mode, np.eye(part.block_size)[[component] * len(mode)])


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_bodies_that_move_together_turn_about_one_middle(comm, model):
    """In a box twice as large as the body its corner turns about a point outside."""
    part = alone(comm, model, formulation="displacement")
    low, high = extent([part.unknowns])
    np.testing.assert_allclose(high - low, [LENGTH, WIDTH, WIDTH][: part.dimension])
    box = (low, low + 2 * (high - low) + [0.0, 1.0, 0.0][: part.dimension])
    middle, half = (box[0] + box[1]) / 2, np.linalg.norm(box[1] - box[0]) / 2
    owned = part.space.dofmap.index_map.size_local
    points = part.mesh.nodes.tabulate_dof_coordinates()[:owned, : part.dimension]
    arms = (points - middle) / half
    about_z = near_null_modes(part.unknowns, box)[-1].reshape(points.shape)
    np.testing.assert_allclose(about_z[:, :2], arms[:, [1, 0]] * [-1.0, 1.0], atol=1e-15)
