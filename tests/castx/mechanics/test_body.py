"""One body: rigid motions, bars with exact stresses, liquid and birth, and trial steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.mechanics.body import BodyMechanics, point_stress
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from tests.castx.mechanics.lone_bodies import MELTING, MODELS, alone, begin, move, slab_mesh
from tests.elastic_bodies import (
    STRESS_FREE,
    body,
    elastic,
    fixed,
    heat,
    motion,
    places,
    problem,
    stresses,
)

pytestmark = pytest.mark.sampled


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
    mesh = slab_mesh(comm, model)
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
    mesh = slab_mesh(comm, "axisymmetric")
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


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_stress_at_points_has_the_mean_of_the_cell_and_the_slopes_of_the_strain(comm, cells):
    made = stretched_block(comm, cells)
    found = point_stress(made).reshape(len(made.stress()), -1, 6)
    np.testing.assert_allclose(found.mean(axis=1), made.stress(), atol=1e-4)
    if cells == "simplices":
        assert found.shape[1] == 1
        return
    # ε_xx = 1e-3 y/L in each cell: the points along the second direction differ, others do not.
    by_direction = found[:, :, 0].reshape(-1, 2, 2, 2)  # third, second, first direction
    spans = [np.abs(np.diff(by_direction, axis=axis)).max(initial=0.0) for axis in (3, 2, 1)]
    assert spans[1] > 1e3 and max(spans[0], spans[2]) < 1e-6 * spans[1]


def stretched_block(comm, cells):
    """Return a body bent so that its strain along x grows with y."""
    formulation = "mixed" if cells == "simplices" else "q1p0"
    part = alone(comm, "3d", cells=cells, formulation=formulation)
    points = part.mesh.nodes.tabulate_dof_coordinates()
    part.update_state(np.full(len(points), STRESS_FREE), np.ones(len(points)), 1.0)
    moved = np.zeros((len(points), part.block_size))
    moved[:, 0] = 0.1 * points[:, 0] * points[:, 1]
    part.solution.x.array[:] = moved.ravel()
    return part


def size_of_forces(part) -> float:
    """Return the size of the internal forces at the present displacement [N]."""
    part.residual()
    return part.mesh.mesh.comm.allreduce(part.force_scale()[0]) ** 0.5


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_the_size_of_forces_is_that_of_the_stress_in_any_axes(comm, model):
    """Stretched along an axis and pressed along another is sheared at 45°."""
    part = alone(comm, model, formulation="displacement")
    begin(part, STRESS_FREE)
    move(part, 1e-4 * np.diag([1.0, -1.0, 0.0]))
    stretched = size_of_forces(part)
    move(part, 1e-4 * np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    assert size_of_forces(part) == pytest.approx(stretched, rel=1e-12)
    assert stretched > 0.0


@pytest.mark.ranks
def test_free_expansion_counts_little_beside_the_stress_it_would_be(comm):
    """By 1e-4 of 2 G tr(e): round-off of it is no force, and a stress of 1e-3 outweighs it."""
    part = alone(comm, "3d", formulation="displacement")
    begin(part, STRESS_FREE + 50.0)
    move(part, 1e-3 * np.eye(3))
    free = size_of_forces(part)
    begin(part, STRESS_FREE)
    move(part, 1e-3 * np.diag([1.0, -1.0, 0.0]))
    assert free == pytest.approx(1e-4 * 3 / 2**0.5 * size_of_forces(part), rel=1e-9)


@pytest.mark.parametrize(
    ("law", "share"), [("thermo-elastic", 0.0), ("thermo-elasto-plastic", 0.9)]
)
def test_only_a_body_that_flows_turns_work_into_heat(comm, law, share):
    metal = elastic(70e9, 0.33, 2e-5, yield_stress=1e8, dissipation=0.9)
    description = MechanicalBody(Law(metal, STRESS_FREE, law))
    made = BodyMechanics(slab_mesh(comm).bodies["casting"], "plane-strain", description)
    assert made.dissipated_fraction == share


@pytest.mark.ranks
def test_flow_of_a_step_is_counted_by_what_is_solid(comm):
    """Held at its ends and cooled by 100 K it flows alike everywhere; then it rests."""
    mesh = slab_mesh(comm)
    metal = elastic(70e9, 0.33, 2e-5, yield_stress=1e7)
    held = [fixed("wall", "x"), fixed("far", "x"), fixed("bottom")]
    given = MechanicalBody(Law(metal, STRESS_FREE, "thermo-elasto-plastic"))
    made = problem(mesh, {"casting": given}, {"casting": held})
    part = made.bodies["casting"]
    cooled(made, STRESS_FREE - 100.0, 1.0)
    squares, solid = comm.allreduce(part.flow_of_solid())
    volume = comm.allreduce(part.points.weights[: part.owned_cells].sum())
    assert solid == pytest.approx(volume, rel=1e-12)
    flowed = comm.allreduce(float(part.plastic_strain().max()), max)
    assert np.sqrt(squares / solid) == pytest.approx(flowed, rel=1e-6)
    assert made.largest_flow() == pytest.approx(flowed, rel=1e-6) and flowed > 1e-4
    made.equilibrium.commit()
    cooled(made, STRESS_FREE - 100.0, 1.0)
    assert made.largest_flow() < 1e-8 * flowed


def test_solid_counts_by_its_share_in_a_cell(comm):
    made = solidifying(comm)
    part = made.bodies["casting"]
    volume = part.points.weights.sum()
    for fraction, share in ((0.0, 0.0), (0.85, 0.5), (1.0, 1.0)):
        cooled(made, 590.0, fraction)
        assert part.flow_of_solid()[1] == pytest.approx(share * volume, rel=1e-9, abs=1e-15)
    assert made.largest_flow() == 0.0


def solidifying(comm, starts_liquid: bool = True):
    """Return a bar of a melting material between rollers, shortened from the first step on."""
    mesh = slab_mesh(comm)
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


E, NU, COOLING = 70e9, 0.33, 2e-3
BORN = E * COOLING / (1 - NU)
"""Stress along and out of plane of a solid that cools by 100 K, held in both directions [Pa]."""


def held_bar(share: float, along: float, cooling: float = COOLING) -> float:
    """Return σ_xx of a bar of one step, with a share of G and 1/K, cooled and stretched [Pa].

    Free across, held out of the plane: s = 2 G dev(ε), p = K (tr ε + 3 α ΔT), s_yy + p = 0.
    """
    G, K = share * E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU)) / share
    across = (2 / 3 * G * along - K * (along + 3 * cooling)) / (4 / 3 * G + K)
    mean = K * (along + across + 3 * cooling)
    return 2 * G * (along - (along + across) / 3) + mean


def test_a_solid_is_born_without_the_strain_of_the_liquid(comm):
    made = solidifying(comm)
    for temperature, solid_fraction in ((640.0, 0.0), (640.0, 0.0), (600.0, 1.0)):
        cooled(made, temperature, solid_fraction)
        made.equilibrium.commit()
    assert np.abs(stresses(comm, made, "casting")).max() < 1.0
    cooled(made, 500.0, 1.0)
    stress = stresses(comm, made, "casting")
    np.testing.assert_allclose(stress[:, [0, 2]], BORN, rtol=1e-8)
    np.testing.assert_allclose(stress[:, [1, 3]], 0.0, atol=1.0)


def test_a_solid_is_born_under_the_pressure_that_acts(comm):
    """Squeezed liquid has p = -2 η ε̇; frozen in one step and relieved, the solid wants to grow."""
    made = solidifying(comm)
    cooled(made, 640.0, 0.0)
    rate = -1e-5 / 0.02
    mean = stresses(comm, made, "casting")[:, :3].mean(axis=1)
    np.testing.assert_allclose(mean, 2 * 2e6 * rate, rtol=1e-6)
    made.equilibrium.commit()
    cooled(made, 600.0, 1.0)
    # ε_xx = ε_zz = 0 and σ_yy = 0, with half of G and of 1/K in the step, and K (tr ε - E) for p.
    G, K = 0.5 * E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU)) / 0.5
    volume = -mean[0] / K
    across = K * volume / (4 / 3 * G + K)
    expected = K * (across - volume) - 2 / 3 * G * across
    np.testing.assert_allclose(stresses(comm, made, "casting")[:, 0], expected, rtol=1e-5)


def test_what_freezes_within_a_step_has_all_of_its_own_contraction(comm):
    made = solidifying(comm)
    cooled(made, 640.0, 0.0)
    made.equilibrium.commit()
    cooled(made, 640.0, 0.0)
    made.equilibrium.commit()
    cooled(made, 500.0, 1.0)
    found = stresses(comm, made, "casting")[:, 0]
    np.testing.assert_allclose(found, held_bar(1.0, 0.0), rtol=1e-8)


def test_a_body_that_starts_solid_keeps_its_strain(comm):
    """Without `starts_liquid` all of the end's displacement in the first step makes stress."""
    along = -1e-5 / 0.02
    for starts_liquid, share in ((False, 1.0), (True, 0.5)):
        made = solidifying(comm, starts_liquid=starts_liquid)
        cooled(made, 600.0, 1.0)
        found = stresses(comm, made, "casting")[:, 0]
        np.testing.assert_allclose(found, held_bar(share, along, cooling=0.0), rtol=1e-8)
    assert held_bar(1.0, along) == pytest.approx(BORN + E / (1 - NU**2) * along)


def test_remelting_wipes_the_strain(comm):
    """A third of it bears when it freezes anew, and all of it while it cools."""
    made = solidifying(comm, starts_liquid=False)
    for temperature, fraction in ((500.0, 1.0), (640.0, 0.0), (640.0, 0.0), (600.0, 0.8)):
        cooled(made, temperature, fraction)
        made.equilibrium.commit()
    cooled(made, 500.0, 1.0)
    found = stresses(comm, made, "casting")[:, 0]
    np.testing.assert_allclose(found, held_bar(1.0, 0.0), rtol=1e-8)


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
