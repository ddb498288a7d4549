"""Bodies of grains: heated, torn, unloaded, burnt, saved; balance, matrix and ranks."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.materials.granular import GranularData, GranularSurface, granular_surface
from castx.mechanics.body import BodyMechanics
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from tests.castx.mechanics.lone_bodies import jacobian_times, move, random_field, slab
from tests.elastic_bodies import STRESS_FREE, elastic

YOUNG, POISSON, EXPANSION = 500e6, 0.25, 1.5e-5
G, K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
BURNING = [(20.0, 0.8e6), (300.0, 0.2e6)]
CUT = 0.15e6
GRAINS: dict[str, Any] = {
    "cohesion": BURNING, "friction_angle": 30.0, "dilatancy_angle": 8.0, "tension_cut_off": CUT,
}  # fmt: skip
CELLS = ("simplices", "quadrilaterals")
MODELS = ("plane-strain", "generalised-plane-strain", "axisymmetric", "3d")


def grains(
    comm: MPI.Intracomm, model: str = "plane-strain", cells: str = "simplices", **changes: Any
) -> BodyMechanics:
    sand = elastic(YOUNG, POISSON, EXPANSION, granular=GRAINS | changes)
    described = MechanicalBody(Law(sand, STRESS_FREE, "drucker-prager"), "displacement")
    return BodyMechanics(slab(comm, model, cells), model, described)


def step(
    part: BodyMechanics, gradient: FloatArray, temperature: float = STRESS_FREE
) -> FloatArray:
    """Take a step to a displacement A x and a temperature; return the mean stress of the points."""
    nodes = len(part.mesh.parent_vertices)
    part.update_state(np.full(nodes, temperature), np.ones(nodes), 1.0)
    part.set_time(0.0)
    move(part, gradient)
    part.update_points()
    return part.material.mean_stress()


def surface_at(temperature: float, **changes: float) -> GranularSurface:
    return granular_surface(GranularData.read(GRAINS | changes), np.array([temperature]))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("cells", CELLS)
@pytest.mark.parametrize("relaxation", [0.0, 0.5])
def test_matrix_is_the_derivative_of_the_residual(comm, model, cells, relaxation) -> None:
    part = grains(comm, model, cells, relaxation_time=relaxation)
    stretch = np.diag([2e-3, -4e-3, 1e-3])
    step(part, stretch)
    start = part.solution.x.array + 5e-6 * random_field(part, 0.7)
    direction = 1e-3 * random_field(part, 1.3)

    def residual(size: float) -> FloatArray:
        part.solution.x.array[:] = start + size * direction
        return part.residual()

    at = residual(0.0)
    flowed = part.material.response.equivalent
    assert 0 < np.count_nonzero(flowed)
    product = jacobian_times(part, direction)
    errors = [
        np.linalg.norm((residual(size) - residual(-size)) / (2 * size) - product)
        for size in (4e-6, 2e-6)
    ]
    scale = np.linalg.norm(product)
    assert np.linalg.norm(at) > 0
    assert errors[1] < 1e-6 * scale
    assert errors[1] < max(0.3 * float(errors[0]), 1e-9 * float(scale))


@pytest.mark.parametrize("cells", CELLS)
def test_sand_heated_between_walls_yields_at_its_strength_there(comm, cells) -> None:
    """One side is free: σ_x = 0, and ε_y = ε_z = 0 against its expansion."""
    part = grains(comm, "plane-strain", cells, friction_angle=15.0, dilatancy_angle=0.0)
    temperature = 260.0
    free = EXPANSION * (temperature - STRESS_FREE)
    surface = surface_at(temperature, friction_angle=15.0, dilatancy_angle=0.0)
    # On the cone q = |σ|, p = 2σ/3 and the flow keeps the volume, so that p = K (ε_x − 3 ε^θ).
    bound = surface.strength[0] / (1 - 2 * surface.friction / 3)
    assert bound < YOUNG * free / (1 - POISSON)
    along = 3 * free - 2 * bound / (3 * K)
    step(part, np.diag([along, 0.0, 0.0]), temperature)
    stress = part.stress()
    assert np.allclose(stress[:, 0], 0, atol=1e-6 * bound)
    assert np.allclose(stress[:, 1:3], -bound, rtol=1e-9)


@pytest.mark.parametrize("cells", CELLS)
def test_sand_without_way_to_shear_is_pressed_elastically(comm, cells) -> None:
    part = grains(comm, "plane-strain", cells)
    free = EXPANSION * 100
    mean = step(part, np.zeros((3, 3)), STRESS_FREE + 100)
    assert np.allclose(mean, -3 * K * free)
    assert not part.material.response.equivalent.any()


@pytest.mark.parametrize("cells", CELLS)
def test_sand_that_was_torn_is_pressed_before_its_gap_is_closed(comm, cells) -> None:
    """What the cut-off has let go stays open when the stretch goes back to nothing."""
    part = grains(comm, "plane-strain", cells)
    assert np.allclose(step(part, np.diag([4e-3, 4e-3, 0])), CUT)
    part.commit()
    assert np.allclose(step(part, np.diag([3.9e-3, 3.9e-3, 0])), CUT - 2e-4 * K)
    assert np.allclose(step(part, np.zeros((3, 3))), CUT - 8e-3 * K, rtol=1e-12)
    part.rewind()
    move(part, np.diag([4e-3, 4e-3, 0]))
    part.update_points()
    assert np.allclose(part.material.mean_stress(), CUT)


def test_sand_relaxes_to_its_cut_off_in_the_relaxation_time(comm) -> None:
    """Held at one stretch, p − t falls by 1/(1 + Δt/τ) in each step."""
    part, stretch = grains(comm, relaxation_time=4.0), 4e-3
    beyond = K * 2 * stretch - CUT
    for _ in range(3):
        mean = step(part, np.diag([stretch, stretch, 0]))
        beyond *= 0.8
        # The stretch shears too, which is far below the cone.
        assert np.allclose(mean, CUT + beyond)
        part.commit()


def test_work_of_the_flow_is_that_of_stress_and_strain_without_the_elastic_part(comm) -> None:
    part = grains(comm)
    sheared = np.array([[0, 6e-3, 0], [0, 0, 0], [0, 0, 0.0]])
    step(part, sheared)
    response, mean = part.material.response, part.material.mean_stress()
    tau = response.stress[:, 3]
    flow = 6e-3 - tau / G
    dilatation = -mean / K
    assert (flow > 1e-3).all() and (dilatation > 1e-5).all()
    assert np.allclose(response.work, tau * flow + mean * dilatation)
    assert np.allclose(response.plastic[:, 3], flow / 2)
    assert np.allclose(part.material.plastic_power(), response.work)


def test_a_binder_that_has_burnt_does_not_come_back(comm) -> None:
    """Pure shear at 20 °C is borne up to k/√3, after 300 °C up to that of the burnt binder."""
    sheared = np.array([[0, 8e-3, 0], [0, 0, 0], [0, 0, 0.0]])
    strength = {}
    for hottest in (STRESS_FREE, 300.0):
        part = grains(comm, dilatancy_angle=0.0)
        step(part, np.diag([1.0, 1, 1]) * EXPANSION * (hottest - STRESS_FREE), hottest)
        part.commit()
        step(part, sheared, STRESS_FREE)
        assert np.allclose(part.material.mean_stress(), 0, atol=1.0)
        strength[hottest] = np.sqrt(3) * part.material.response.stress[:, 3]
    assert np.allclose(strength[STRESS_FREE], surface_at(STRESS_FREE).strength[0])
    assert np.allclose(strength[300.0], surface_at(300.0).strength[0])


@pytest.mark.parametrize(
    "changes",
    [{"cohesion": 0.9e6}, {"friction_angle": 32.0}, {"dilatancy_angle": 3.0},
     {"tension_cut_off": 0.05e6}, {"relaxation_time": 0.1}],
)  # fmt: skip
def test_each_parameter_changes_the_stress(comm, changes) -> None:
    stretches = [np.diag([5e-3, -9e-3, 0]), np.diag([4e-3, 4e-3, 0.0])]
    found, cases = [], list[dict[str, Any]]([{}, changes])
    for given in cases:
        part = grains(comm, **given)
        found.append(np.array([step(part, stretch) for stretch in stretches]))
    assert not np.allclose(found[0], found[1], rtol=1e-4)


@pytest.mark.parametrize("cells", CELLS)
def test_history_goes_through_a_checkpoint(comm, cells) -> None:
    part, other = (grains(comm, "plane-strain", cells) for _ in range(2))
    sheared = np.array([[4e-3, 8e-3, 0], [0, 1e-3, 0], [0, 0, 0.0]])
    step(part, sheared, 250.0)
    part.commit()
    for name, saved in part.stateful_parts().items():
        arrays = {key: value.values for key, value in saved.saved().items()}
        other.stateful_parts()[name].restore(arrays)
    for each in (part, other):
        step(each, np.diag([1e-3, -2e-3, 0]))
    assert np.array_equal(part.material.mean_stress(), other.material.mean_stress())
    assert np.array_equal(part.material.response.stress, other.material.response.stress)
    fresh = grains(comm, "plane-strain", cells)
    step(fresh, np.diag([1e-3, -2e-3, 0]))
    assert not np.allclose(fresh.material.mean_stress(), part.material.mean_stress())


@pytest.mark.ranks
def test_totals_are_those_of_one_rank(comm) -> None:
    """Forces at the fixed ends of a slab that yields from place to place."""
    part = grains(comm, "3d")
    step(part, np.diag([3e-3, -3e-3, 1e-3]))
    part.solution.x.array[:] += 2e-6 * random_field(part, 0.4)
    forces = part.residual()
    work = part.nodal_plastic_power()
    totals = comm.allreduce(np.array([forces @ forces, work.sum()]), op=MPI.SUM)
    assert (totals > 0).all()
    if comm.size == 1:
        return
    alone_part = grains(MPI.COMM_SELF, "3d")
    step(alone_part, np.diag([3e-3, -3e-3, 1e-3]))
    alone_part.solution.x.array[:] += 2e-6 * random_field(alone_part, 0.4)
    forces = alone_part.residual()
    expected = [forces @ forces, alone_part.nodal_plastic_power().sum()]
    assert np.allclose(totals, expected, rtol=1e-9)
