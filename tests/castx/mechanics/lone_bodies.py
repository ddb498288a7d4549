"""One body without contact: its mesh, states that are not special, and its Jacobian."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.mechanics.body import BodyMechanics
from tests.elastic_bodies import body, elastic, generated

LENGTH, WIDTH = 0.02, 0.01
YOUNG, POISSON = 70e9, 0.33
PLANE_MODELS = ("plane-strain", "generalised-plane-strain", "plane-stress", "axisymmetric")
MODELS = (*PLANE_MODELS, "3d")
MELTING: dict[str, Any] = {
    "solidus": 600.0,
    "liquidus": 650.0,
    "latent_heat": 4e5,
    "liquid": {"viscosity": 2e6, "coherency": 0.7},
}
SHUT = ("wall", "far", "bottom", "top")
"""Surfaces of the slab in the plane: closed, no liquid can follow."""


def slab_mesh(
    comm: MPI.Intracomm, model: str = "plane-strain", cells: str = "simplices"
) -> CastingMesh:
    """Return a slab "casting" with surfaces wall, far, bottom, top and, in 3-D, back and front."""
    depth = {"depth": WIDTH} if model == "3d" else {}
    sizes: dict[str, Any] = {"length": LENGTH, "width": WIDTH, "size": 0.005, **depth}
    return generated(comm, model, "slab", ["casting"], cells=cells, **sizes)


def slab(comm: MPI.Intracomm, model: str = "plane-strain", cells: str = "simplices") -> BodyMesh:
    """Return the body of `slab_mesh`."""
    return slab_mesh(comm, model, cells).bodies["casting"]


def alone(
    comm: MPI.Intracomm,
    model: str = "plane-strain",
    cells: str = "simplices",
    properties: Any = None,
    **description: Any,
) -> BodyMechanics:
    """Return a slab of an elastic material that expands."""
    metal = elastic(YOUNG, POISSON, 2e-5, **(properties or {}))
    return BodyMechanics(slab(comm, model, cells), model, body(metal, **description))


def random_field(part: BodyMechanics, seed: float) -> FloatArray:
    """Return values of the local unknowns that depend on their places only."""
    points = np.abs(part.mesh.nodes.tabulate_dof_coordinates()) / LENGTH
    phase = 1.0 + points @ [13.1, 17.3, 23.9]
    return np.sin(seed * (phase[:, None] + 4.3 * np.arange(part.block_size)) ** 1.3).ravel()


def begin(
    part: BodyMechanics, temperature: float, solid_fraction: float | FloatArray = 1.0
) -> None:
    """Start a step of 1 s at one temperature."""
    nodes = len(part.mesh.parent_vertices)
    part.update_state(np.full(nodes, temperature), np.full(nodes, solid_fraction), 1.0)
    part.set_time(0.0)


def molten_quadrilaterals(comm: MPI.Intracomm) -> BodyMechanics:
    """Return a body of liquid in a step of 1 s, whose pressures are multipliers of its cells."""
    part = alone(
        comm, "plane-strain", "quadrilaterals", properties=MELTING, formulation="q1p0",
        starts_liquid=True,
    )  # fmt: skip
    begin(part, 640.0, 0.0)
    return part


def molten_ends(part: BodyMechanics) -> FloatArray:
    """Return solid fractions of the local nodes that leave two pockets, at both ends of a slab."""
    x = part.mesh.points[:, 0]
    return np.where((x < 0.3 * LENGTH) | (x > 0.7 * LENGTH), 0.0, 1.0)


def begin_anywhere(part: BodyMechanics, solid_fraction: float | FloatArray = 1.0) -> None:
    """Start a step of 1 s at temperatures that differ from place to place."""
    nodes = len(part.mesh.parent_vertices)
    temperature = 20 + 300 * np.abs(random_field(part, 0.3)[:nodes])
    part.update_state(temperature, np.full(nodes, solid_fraction), 1.0)
    part.set_time(0.0)


def move(part: BodyMechanics, gradient: FloatArray, pressure: float = 0.0) -> None:
    """Give a body the displacement A x and one pressure."""
    d = part.dimension
    points = part.mesh.nodes.tabulate_dof_coordinates()[:, :d]
    values = np.zeros((len(points), part.block_size))
    values[:, :d] = points @ gradient[:d, :d].T
    if part.unknowns.pressure_component is not None:
        values[:, part.unknowns.pressure_component] = pressure / part.unknowns.pressure_scale
    part.solution.x.array[:] = values.ravel()


def jacobian_times(part: BodyMechanics, direction: FloatArray) -> FloatArray:
    """Return the Jacobian times a field of the local unknowns, at the owned unknowns."""
    A = part.formulation.forms.create_jacobian()
    part.formulation.assemble_jacobian(A)
    x, y = A.createVecs()
    x.array[:] = direction[: x.getLocalSize()]
    A.mult(x, y)
    product = y.array_r.copy()
    for add_product in (*part.formulation.products(), *part.formulation.coupled_products()):
        add_product(x.array_r, product)
    for item in (A, x, y):
        item.destroy()
    return product


def check_derivative(comm: MPI.Intracomm, part: BodyMechanics, amplitude: float) -> None:
    """Hold the Jacobian against differences of the residual about a random state.

    The material is linear, so that central differences are exact but for rounding.
    """
    here, direction = amplitude * random_field(part, 1.1), random_field(part, 2.3)
    size = 1e-3 * amplitude
    part.solution.x.array[:] = here + size * direction
    after = part.residual()
    part.solution.x.array[:] = here - size * direction
    difference = (after - part.residual()) / (2 * size)
    product = jacobian_times(part, direction)
    scale = comm.allreduce(np.abs(product).max(initial=0.0), op=MPI.MAX)
    np.testing.assert_allclose(difference, product, atol=1e-6 * scale, rtol=0)
    A = part.formulation.forms.create_jacobian()
    part.formulation.assemble_jacobian(A)
    assert A.isSymmetric(1e-6 * scale)
    A.destroy()


def inside(part: BodyMechanics) -> FloatArray:
    """Return 1 at the owned nodes that lie on no surface, else 0."""
    free = np.ones(part.owned_nodes)
    for name in part.mesh.surfaces:
        nodes = part.mesh.surface_nodes(name)
        free[nodes[nodes < part.owned_nodes]] = 0.0
    return free
