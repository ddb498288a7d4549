"""One body: Jacobian, liquid and birth, loads, and what each parameter does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from castx.domain.measures import nodal_mean
from castx.mechanics.body import BodyMechanics
from castx.mechanics.description import SurfaceLoad
from castx.tables import Table
from tests.elastic_bodies import (
    STRESS_FREE,
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    places,
    problem,
    pulled,
    pushed,
    stresses,
)

MODELS = ("plane-strain", "plane-stress", "axisymmetric", "3d")
MELTING = {
    "solidus": 600.0,
    "liquidus": 600.0,
    "latent_heat": 4e5,
    "liquid": {"viscosity": 2e6, "coherency": 0.7},
}


def slab(comm, model: str = "plane-strain"):
    depth = {"depth": 0.01} if model == "3d" else {}
    return generated(
        comm, model, "slab", ["casting"], length=0.02, width=0.01, size=0.005, **depth
    )


def alone(comm, model: str, **description: Any) -> BodyMechanics:
    solid = body(elastic(70e9, 0.33, 2e-5), **description)
    return BodyMechanics(slab(comm, model).bodies["casting"], model, solid)


def random_field(part: BodyMechanics, seed: float) -> np.ndarray:
    """Return values at the local unknowns that depend on the global number only."""
    index_map, size = part.space.dofmap.index_map, part.block_size
    local = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
    numbers = index_map.local_to_global(local)[:, None] * size + np.arange(size)
    return np.sin(seed * (1.0 + numbers.ravel()) ** 1.3)


@pytest.mark.parametrize(
    "description",
    [{"stabilisation": "osgs"}, {"stabilisation": "gls"}, {"formulation": "displacement"}],
    ids=["osgs", "gls", "displacement"],
)
@pytest.mark.parametrize("model", MODELS)
def test_jacobian_is_the_derivative_of_the_residual(comm, model, description):
    loads = (pushed("far", 1e6), pulled("wall", *(2e6,) * (3 if model == "3d" else 2)))
    part = alone(comm, model, loads=loads, body_force=(1e6, -3e6), **description)
    nodes = len(part.mesh.parent_vertices)
    temperature = 20 + 300 * np.abs(random_field(part, 0.3)[:nodes])
    part.update_state(temperature, np.ones(nodes), 1.0)
    part.set_time(0.0)
    at, direction, size = random_field(part, 1.1), random_field(part, 2.3), 1e-3
    part.solution.x.array[:] = at + size * direction
    after = part.residual()
    part.solution.x.array[:] = at - size * direction
    difference = (after - part.residual()) / (2 * size)

    A = part.create_jacobian()
    part.assemble_jacobian(A)
    x, y = A.createVecs()
    owned = x.getLocalSize()
    x.array[:] = direction[:owned]
    A.mult(x, y)
    product = y.array_r.copy()
    for add_product in part.products():
        add_product(x.array_r, product)
    scale = comm.allreduce(np.abs(product).max(initial=0.0), op=max)
    np.testing.assert_allclose(difference, product, atol=1e-6 * scale, rtol=0)
    assert A.isSymmetric(1e-6 * scale)


@pytest.mark.parametrize("model", MODELS)
def test_rigid_motions_are_free_of_force(comm, model):
    part = alone(comm, model)
    points = part.mesh.nodes.tabulate_dof_coordinates()
    nodes = len(points)
    part.update_state(np.full(nodes, STRESS_FREE), np.ones(nodes), 1.0)
    moved = np.zeros((nodes, part.block_size))
    if model == "axisymmetric":
        moved[:, 1] = 1.0
    else:
        moved[:, 0] = 1.0 - points[:, 1]
        moved[:, 1] = 2.0 + points[:, 0]
    part.solution.x.array[:] = moved.ravel()
    largest = comm.allreduce(np.abs(part.residual()).max(initial=0.0), op=max)
    assert largest < 1e-12 * 70e9 * 0.02
    assert np.abs(part.stress()).max(initial=0.0) < 1e-9 * 70e9


def stretched(comm, model: str, strain: float, **description: Any):
    """Return a bar between rollers and a displaced end."""
    mesh = slab(comm, model)
    direction = "r" if model == "axisymmetric" else "x"
    held = [fixed("wall", direction), fixed("far", direction, 0.02 * strain), fixed("bottom")]
    if model == "3d":
        held.append(fixed("back"))
    solid = body(elastic(70e9, 0.33, 2e-5), **description)
    return problem(mesh, {"casting": solid}, {"casting": held})


@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
@pytest.mark.parametrize("model", ["plane-strain", "plane-stress", "3d"])
def test_a_hot_bar_between_walls(comm, model, formulation):
    """σ_xx = E' (ε - (1 + ν)αΔT or αΔT), the other directions free."""
    made = stretched(comm, model, 1e-3, formulation=formulation)
    heat(made, STRESS_FREE + 100.0)
    made.equilibrium.solve(0.0)
    E, nu, thermal = 70e9, 0.33, 2e-3
    if model == "plane-strain":
        expected = (E / (1 - nu**2) * (1e-3 - (1 + nu) * thermal), 0.0)
        out_of_plane = nu * expected[0] - E * thermal
    else:
        expected, out_of_plane = (E * (1e-3 - thermal), 0.0), 0.0
    stress = stresses(comm, made, "casting")
    np.testing.assert_allclose(stress[:, 0], expected[0], rtol=1e-8)
    np.testing.assert_allclose(stress[:, 1], 0.0, atol=1.0)
    np.testing.assert_allclose(stress[:, 2], out_of_plane, rtol=1e-8, atol=1.0)
    np.testing.assert_allclose(stress[:, 3:], 0.0, atol=1.0)


@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
def test_an_axisymmetric_body_expands_freely(comm, formulation):
    mesh = slab(comm, "axisymmetric")
    solid = body(elastic(70e9, 0.33, 2e-5), formulation=formulation)
    made = problem(mesh, {"casting": solid}, {"casting": [fixed("bottom", "z")]})
    heat(made, STRESS_FREE + 100.0)
    made.equilibrium.solve(0.0)
    found, points = motion(made, "casting"), places(made, "casting")
    np.testing.assert_allclose(found[:, :2], 2e-3 * points, atol=1e-10 * 2e-5)
    np.testing.assert_allclose(stresses(comm, made, "casting"), 0.0, atol=1.0)


def test_stress_components_of_a_shear_in_space(comm):
    part = alone(comm, "3d")
    points = part.mesh.nodes.tabulate_dof_coordinates()
    nodes = len(points)
    part.update_state(np.full(nodes, STRESS_FREE), np.ones(nodes), 1.0)
    moved = np.zeros((nodes, 4))
    shear = np.array([[0, 1, 2], [3, 0, 4], [5, 6, 0]]) * 1e-3
    moved[:, :3] = points @ shear.T
    part.solution.x.array[:] = moved.ravel()
    G = 70e9 / (2 * 1.33)
    expected = G * np.array([0, 0, 0, 4e-3, 7e-3, 10e-3])
    np.testing.assert_allclose(part.stress(), np.tile(expected, (len(part.stress()), 1)), atol=1.0)


def solidifying(comm, starts_liquid: bool = True):
    """Return a bar of a melting material between rollers, shortened from the first step on."""
    mesh = slab(comm)
    material = elastic(70e9, 0.33, 2e-5, **MELTING)
    held = [fixed("wall", "x"), fixed("far", "x", -1e-5), fixed("bottom")]
    casting = body(material, stress_free=600.0, starts_liquid=starts_liquid)
    return problem(mesh, {"casting": casting}, {"casting": held})


def test_a_liquid_carries_viscous_stress_only(comm):
    """Squeezed in one step between walls, s = 2 η ė and p = 0 at the free top: σ_xx = 4 η ε̇."""
    made = solidifying(comm)
    for step in (0.5, 2.0):
        heat(made, 640.0, 0.0, step)
        made.equilibrium.solve(0.0)
        stress = stresses(comm, made, "casting")
        rate = -1e-5 / 0.02 / step
        np.testing.assert_allclose(stress[:, 0], 4 * 2e6 * rate, rtol=1e-8)
        np.testing.assert_allclose(stress[:, 1], 0.0, atol=1e-6 * abs(4 * 2e6 * rate))
    made.equilibrium.commit()
    heat(made, 640.0, 0.0, 2.0)
    made.equilibrium.solve(0.0)
    assert np.abs(stresses(comm, made, "casting")).max() < 1e-3, "a liquid at rest has no stress"


def cooled(made, temperature: float, solid_fraction: float) -> None:
    heat(made, temperature, solid_fraction)
    made.equilibrium.solve(0.0)


BORN = 70e9 * 2e-3 / (1 - 0.33)
"""Stress along and out of plane of a solid that cools by 100 K, held in both directions [Pa]."""


def test_a_solid_is_born_without_the_strain_of_the_liquid(comm):
    made = solidifying(comm)
    for temperature, solid_fraction in ((640.0, 0.0), (600.0, 1.0)):
        cooled(made, temperature, solid_fraction)
        made.equilibrium.commit()
    assert np.abs(stresses(comm, made, "casting")).max() < 1.0
    cooled(made, 500.0, 1.0)
    stress = stresses(comm, made, "casting")
    np.testing.assert_allclose(stress[:, [0, 2]], BORN, rtol=1e-8)
    np.testing.assert_allclose(stress[:, [1, 3]], 0.0, atol=1.0)


def test_the_whole_increment_of_the_freezing_step_acts(comm):
    made = solidifying(comm)
    cooled(made, 640.0, 0.0)
    made.equilibrium.commit()
    cooled(made, 500.0, 1.0)
    np.testing.assert_allclose(stresses(comm, made, "casting")[:, 0], BORN, rtol=1e-8)


def test_a_body_that_starts_solid_keeps_its_strain(comm):
    """Without `starts_liquid` the end's displacement in the first step makes stress."""
    made = solidifying(comm, starts_liquid=False)
    cooled(made, 500.0, 1.0)
    E, nu = 70e9, 0.33
    added = E / (1 - nu**2) * -5e-4
    np.testing.assert_allclose(stresses(comm, made, "casting")[:, 0], BORN + added, rtol=1e-8)
    made = solidifying(comm)
    cooled(made, 500.0, 1.0)
    np.testing.assert_allclose(stresses(comm, made, "casting")[:, 0], BORN + added, rtol=1e-8)


def test_remelting_wipes_the_strain(comm):
    made = solidifying(comm, starts_liquid=False)
    for temperature, solid_fraction in ((500.0, 1.0), (640.0, 0.0), (600.0, 0.8)):
        cooled(made, temperature, solid_fraction)
        made.equilibrium.commit()
    cooled(made, 500.0, 1.0)
    np.testing.assert_allclose(stresses(comm, made, "casting")[:, 0], BORN, rtol=1e-8)


def test_coherency_decides_what_is_liquid(comm):
    made = solidifying(comm)
    for solid_fraction, solid in ((0.69, False), (0.71, True)):
        heat(made, 590.0, solid_fraction)
        assert np.all(made.bodies["casting"].coherent == solid)


def test_a_trial_step_leaves_no_trace(comm):
    made, plain = solidifying(comm), solidifying(comm)
    for temperature, solid_fraction in ((640.0, 0.0), (590.0, 1.0), (500.0, 1.0)):
        cooled(made, 700.0, 0.0)
        cooled(made, 100.0, 1.0)
        made.equilibrium.rewind()
        for each in (made, plain):
            cooled(each, temperature, solid_fraction)
            each.equilibrium.commit()
    np.testing.assert_allclose(motion(made, "casting"), motion(plain, "casting"), rtol=1e-9)
    np.testing.assert_allclose(
        made.bodies["casting"].stress(), plain.bodies["casting"].stress(), atol=1.0
    )


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


VARIATIONS: dict[str, Callable[[], Any]] = {
    "formulation": lambda: body(elastic(70e9, 0.33, 2e-5), formulation="displacement"),
    "stabilisation": lambda: body(elastic(70e9, 0.33, 2e-5), stabilisation="gls"),
    "body_force": lambda: body(elastic(70e9, 0.33, 2e-5), body_force=(1e6, 0.0)),
    "loads": lambda: body(elastic(70e9, 0.33, 2e-5), loads=(pushed("far", 1e6),)),
    "stress_free": lambda: body(elastic(70e9, 0.33, 2e-5), stress_free=40.0),
    "young_modulus": lambda: body(elastic([[0.0, 70e9], [100.0, 40e9]], 0.33, 2e-5)),
    "poisson_ratio": lambda: body(elastic(70e9, 0.3, 2e-5)),
    "expansion": lambda: body(elastic(70e9, 0.33, 1e-5)),
}


@pytest.mark.parametrize("name", VARIATIONS)
def test_every_parameter_changes_the_answer(comm, name):
    answers = []
    for solid in (body(elastic(70e9, 0.33, 2e-5)), VARIATIONS[name]()):
        made = problem(slab(comm), {"casting": solid}, {"casting": [fixed("wall", "all")]})
        heat(made, lambda x: 20 + 4e3 * x[:, 0])
        made.equilibrium.solve(0.0)
        answers.append(everywhere(comm, motion(made, "casting")[:, :2]))
    change = np.abs(answers[1] - answers[0]).max()
    assert change > 1e-4 * np.abs(answers[0]).max()


def test_cell_values_become_nodal_means(comm):
    part = alone(comm, "plane-strain")
    constant = nodal_mean(part.mesh, np.full(len(part.cell_nodes), 3.5))
    np.testing.assert_allclose(constant, 3.5, rtol=1e-14)
