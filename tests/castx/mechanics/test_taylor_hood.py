"""Taylor-Hood formulation: Jacobian, quadratic motions, liquid at rest, trapped liquid."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from castx.mechanics.assembly import BodyAssembly
from castx.mechanics.body import point_stress
from castx.solvers.layout import Layout
from tests.castx.mechanics.lone_bodies import (
    LENGTH,
    MELTING,
    MODELS,
    POISSON,
    SHUT,
    YOUNG,
    alone,
    begin,
    begin_anywhere,
    molten_ends,
    random_field,
)
from tests.elastic_bodies import STRESS_FREE, everywhere, pushed

pytestmark = [pytest.mark.sampled, pytest.mark.ranks]

quadratic = partial(alone, formulation="taylor-hood")
FORCE = 26.5e3


def assembled(comm, part) -> BodyAssembly:
    spaces = part.space, part.midsides.space
    maps = [space.dofmap.index_map for space in spaces]
    return BodyAssembly(Layout(comm, maps, [part.block_size, part.midsides.block_size]), [part])


def bubbles(part, seed: float):
    """Return values of the local mid-sides that depend on their places only."""
    ends = np.abs(part.mesh.points[part.midsides.ends].sum(axis=1)) / LENGTH
    phase = ends @ [13.1, 17.3, 23.9][: part.dimension]
    return np.sin(seed * (phase[:, None] + 4.3 * np.arange(part.dimension)) ** 1.3).ravel()


def owned_field(part, seed: float):
    """Return random owned unknowns of nodes and mid-sides."""
    of_midsides = bubbles(part, seed)[: part.midsides.owned]
    return np.concatenate([random_field(part, seed)[: part.unknowns.owned], of_midsides])


def check_derivative(comm, part):
    """Central differences are exact but for rounding: the material is linear."""
    assembly = assembled(comm, part)
    here, direction = owned_field(part, 1.1), owned_field(part, 2.3)

    def residual(shift):
        assembly.unknowns.array[:] = here + shift * direction
        return assembly.residual().array_r.copy()

    difference = (residual(1e-3) - residual(-1e-3)) / 2e-3
    x, y = assembly.matrix().createVecs()
    x.array[:] = direction
    assembly.matrix().mult(x, y)
    product = y.array_r.copy()
    for correction in assembly.coupled_corrections():
        correction(direction, product)
    scale = np.abs(everywhere(comm, product)).max()
    np.testing.assert_allclose(difference, product, atol=1e-6 * scale, rtol=0)
    assert assembly.matrix().isSymmetric(1e-6 * scale)
    assembly.destroy()


@pytest.mark.parametrize("model", MODELS)
def test_jacobian_is_the_derivative_of_the_residual(comm, model):
    part = quadratic(comm, model, loads=(pushed("far", 1e6),), body_force=(1e6, -3e6))
    begin_anywhere(part)
    check_derivative(comm, part)


@pytest.mark.parametrize("ends", [False, True], ids=["all", "ends"])
def test_jacobian_of_trapped_liquid(comm, ends):
    """Full, in one pocket or in two with a shell between them: mid-sides move its volume too."""
    part = quadratic(comm, properties=MELTING, closed=SHUT, starts_liquid=True)
    begin_anywhere(part, molten_ends(part) if ends else 0.2)
    assert part.formulation.has_pockets
    check_derivative(comm, part)


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_quadratic_motions_and_linear_pressures_are_exact(comm, model):
    """With a x y along x, stresses at the points are those of their strain, 2 G e + p 1."""
    part = quadratic(comm, model)
    begin(part, STRESS_FREE)
    points, d, a = part.mesh.points, part.dimension, 3.0
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 0] = a * points[:, 0] * points[:, 1]
    bulk = YOUNG / (3 * (1 - 2 * POISSON))
    values[:, d] = bulk * a * points[:, 1] / part.unknowns.pressure_scale
    ends = points[part.midsides.ends]
    of_edges = part.midsides.solution.x.array.reshape(-1, d)
    of_edges[:, 0] = -0.25 * a * np.prod(ends[:, 1, :2] - ends[:, 0, :2], axis=1)
    shear = YOUNG / (2 * (1 + POISSON))
    places = np.asarray(part.points.places)[np.lexsort(part.points.places.round(12).T)]
    weights = np.column_stack([1 - places.sum(axis=1), places])
    x, y = np.einsum("pv,cvi->ipc", weights, points[part.cell_nodes])[:2]
    found = point_stress(part).reshape(part.points.cells, -1, 6).transpose(1, 0, 2)
    volume = a * y
    expected = np.zeros((*x.shape, 6))
    expected[..., :3] = ((bulk - 2 * shear / 3) * volume)[..., None]
    expected[..., 0] += 2 * shear * volume
    expected[..., 3] = shear * a * x
    np.testing.assert_allclose(found, expected, atol=1e-9 * YOUNG * a * LENGTH)
    means = part.stress()
    corners = points[part.cell_nodes].mean(axis=1)
    np.testing.assert_allclose(means[:, :3].mean(axis=1), bulk * a * corners[:, 1], rtol=1e-9)


@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_a_liquid_at_rest_carries_its_weight_by_its_pressure(comm, model):
    """∇p = -b needs no motion: no mid-side has a force but at the surface."""
    weight = (0.0, -FORCE, 0.0)
    part = quadratic(comm, model, properties=MELTING, starts_liquid=True, body_force=weight)
    begin(part, 640.0, 0.0)
    values = part.solution.x.array.reshape(-1, part.block_size)
    heights = part.mesh.points[:, 1]
    values[:, part.dimension] = FORCE * heights / part.unknowns.pressure_scale
    part.residual()
    forces = part.formulation.midside_residual().reshape(-1, part.dimension)
    midsides = part.midsides
    inner = np.ones(midsides.count, dtype=bool)
    for surface in part.mesh.surfaces:
        inner[midsides.on_surface(surface)] = False
    if part.model == "axisymmetric":
        inner &= np.abs(part.mesh.points[midsides.ends][:, :, 0]).min(axis=1) > 0
    size = FORCE * LENGTH * 0.005 ** (part.dimension - 1)
    there = forces[inner[: midsides.owned_midsides]]
    assert comm.allreduce(len(there)) > 0
    assert np.abs(there).max(initial=0.0) < 1e-10 * size


def test_cells_of_trapped_liquid_have_the_pressure_of_their_pocket(comm):
    part = quadratic(
        comm, properties={**MELTING, "cavitation": 3e5}, closed=SHUT, starts_liquid=True
    )
    begin(part, 640.0, molten_ends(part))
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 0] = 1e-3 * part.mesh.points[:, 0]  # pores open
    values[:, part.dimension] = 7e5 / part.unknowns.pressure_scale
    part.residual()
    found, liquid = part.formulation.mean_stress(), ~part.coherent
    assert comm.allreduce(int(liquid.sum())) and comm.allreduce(int((~liquid).sum()))
    np.testing.assert_allclose(found, np.where(liquid, 3e5, 7e5), rtol=1e-12)
