"""Strain out of the plane: a melt keeps its thickness, and the solid counts from its freezing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.equilibrium.equilibrium import Equilibrium
from castx.equilibrium.problem import MechanicalProblem
from castx.mechanics.body import BodyMechanics
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.stateful import Arrays, restore_parts, saved_parts
from castx.tables import Table
from tests.castx.mechanics.lone_bodies import LENGTH, WIDTH, check_derivative, slab_mesh
from tests.coupled_cases import final_state
from tests.elastic_bodies import (
    STRESS_FREE,
    centres,
    elastic,
    everywhere,
    fixed,
    heat,
    motion,
    places,
    problem,
    stresses,
)

YOUNG, POISSON = 70e9, 0.33
WEIGHT = 26.5e3  # N/m³
SHRINKAGE, COHERENCY = 0.03, 0.7
FREE = SHRINKAGE * (1.0 - COHERENCY) / 3
"""Strain of freezing in each direction."""
MELTING = {
    "solidus": 600.0, "liquidus": 650.0, "latent_heat": 4e5,
    "liquid": {"viscosity": 1.0, "coherency": COHERENCY},
}  # fmt: skip
THICK = {"viscosity": 1e5, "coherency": COHERENCY}
KINDS = [
    ("generalised-plane-strain", "mixed", "osgs"),
    ("generalised-plane-strain", "mixed", "gls"),
    ("generalised-plane-strain", "q1p0", "osgs"),
    ("plane-stress", "mixed", "osgs"),
]
every_kind = pytest.mark.parametrize("kind", KINDS, ids="-".join)
pytestmark = pytest.mark.sampled


def described(kind: tuple[str, str, str], body_force: Any = (), **more: Any) -> MechanicalBody:
    metal = elastic(YOUNG, POISSON, **{**MELTING, **more})
    return MechanicalBody(
        Law(metal, STRESS_FREE), formulation=kind[1], stabilisation=kind[2], starts_liquid=True,
        body_force=body_force,
    )  # fmt: skip


def melt(comm, kind: tuple[str, str, str], far: Table, **more: Any) -> MechanicalProblem:
    """Return a melt on a floor between a wall and one that moves."""
    cells = "quadrilaterals" if kind[1] == "q1p0" else "simplices"
    return problem(
        slab_mesh(comm, kind[0], cells), {"casting": described(kind, **more)},
        {"casting": [fixed("wall"), fixed("bottom"), SurfaceDisplacement("far", "x", far)]},
    )  # fmt: skip


def moved(*strains: float) -> Table:
    """Return the displacement of the far wall for strains along x at 0, 1, 2, … seconds."""
    return Table.from_points([[float(n), e * LENGTH] for n, e in enumerate(strains)])


def below(points: Any) -> Any:
    """Return the solid fraction of a slab that is solid at its floor, in half of its cells."""
    return (points[:, 1] < WIDTH / 4).astype(float)


def accept(made: MechanicalProblem, time: float, solid: Any) -> None:
    heat(made, STRESS_FREE, solid)
    made.equilibrium.solve(time)
    made.equilibrium.commit()


@pytest.mark.ranks
@every_kind
def test_a_pool_keeps_its_level(comm, kind):
    """Between walls a melt carries its weight by p = -ρ g (H - y) and moves nowhere."""
    made = melt(comm, kind, moved(0.0, 0.0), body_force=(0.0, -WEIGHT))
    for time in (1.0, 2.0, 3.0):
        accept(made, time, 0.0)
    dimension = made.bodies["casting"].dimension
    found = motion(made, "casting")[:, :dimension]
    assert np.abs(found).max(initial=0.0) < 1e-9 * LENGTH
    pressure = stresses(comm, made, "casting")[:, :3].mean(axis=1)
    depth = WIDTH - everywhere(comm, centres(made=made, comm=comm, name="casting"))[:, 1]
    np.testing.assert_allclose(pressure, -WEIGHT * depth[: len(pressure)], rtol=1e-6)


@pytest.mark.ranks
@every_kind
def test_a_melt_on_a_solid_keeps_its_thickness(comm, kind):
    """Half of the lower half freezes: it shrinks by ε along its floor, the wall follows.

    Its volume shrinks by 3 ε/2, so that it rises by ε/2, and the melt above it, which keeps its
    thickness, by ε. Triangles of the lower half, with one node in the solid or two, strain alike on
    the mean.
    """
    made = melt(comm, kind, moved(0.0, 0.0, -FREE), solidification_shrinkage=SHRINKAGE)
    accept(made, 1.0, 0.0)
    heat(made, lambda points: STRESS_FREE + 1e-3 * points[:, 1], below)
    made.equilibrium.solve(2.0)
    made.equilibrium.commit()
    stress = np.abs(stresses(comm, made, "casting")).max() / (YOUNG * FREE)
    if kind[1] == "q1p0":
        check_heights(made, 0.5 * FREE, FREE, FREE)
        assert stress < 1e-6
        return
    part = made.bodies["casting"]
    area = part.material.points.weights.sum(axis=1)[: part.material.points.owned_cells]
    plane = part.material.dilatation[: len(area)]
    lost, all_of_it = comm.allreduce(area @ plane), comm.allreduce(area.sum())
    assert lost == pytest.approx(-0.75 * FREE * all_of_it, rel=0.02)
    assert stress < 0.05


@pytest.mark.ranks
@every_kind
def test_solid_shrinks_out_of_the_plane_from_its_freezing_on(comm, kind):
    """Frozen, shrunk by ε, molten with its thickness and its first volume, frozen and shrunk."""
    far = moved(0.0, 0.0, -FREE, -FREE, -2 * FREE)
    made = melt(comm, kind, far, solidification_shrinkage=SHRINKAGE)
    part = made.bodies["casting"]
    accept(made, 1.0, 0.0)
    for time, solid, height, thickness in ((2, 1.0, -1, -1), (3, 0.0, 2, -1), (4, 1.0, 1, -2)):
        accept(made, float(time), solid)
        check_heights(made, height * FREE, height * FREE, FREE)
        assert np.abs(stresses(comm, made, "casting")).max() < 1e-5 * YOUNG * FREE
        if part.axial is not None:
            found = motion(made, "casting")[:, part.axial] / part.length
            np.testing.assert_allclose(found, thickness * FREE, rtol=1e-5)


@every_kind
def test_what_freezes_while_a_bar_is_pulled_bears_from_then_on(comm, kind):
    """Half of the metal is pulled by e_1, the rest freezes, and all is pulled by e_2 more.

    It is free across and out of the plane, so that it has the stress of a bar, with w G and K/w
    while a share w bears: Young's modulus 9 K G/(3 K/w + w G).
    """
    one, two, w = 1e-3, 5e-4, 0.5
    G, K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
    made = melt(comm, kind, moved(0.0, 0.0, 0.0, one, one, one + two))
    half = COHERENCY + w * (1 - COHERENCY)
    for time, solid in ((1.0, 0.0), (2.0, half), (3.0, half), (4.0, 1.0), (5.0, 1.0)):
        accept(made, time, solid)
    stress = stresses(comm, made, "casting")
    along = 9 * K * G / (3 * K / w + w * G) * one + YOUNG * two
    np.testing.assert_allclose(stress[:, 0], along, rtol=1e-6)
    assert np.abs(stress[:, [1, 2, 3]]).max() < 1e-6 * along


@pytest.mark.ranks
def test_melt_beside_solid_in_a_cell_keeps_its_thickness(comm):
    """Its weight drove it out of the plane, by 2 % in ten seconds and by all in an hour."""
    data = {
        "geometry": {"generator": "box_in_mould", "model": "plane-stress", "box": [0.2, 0.15],
                     "wall": 0.06, "size": 0.04},
        "bodies": [
            {"name": "casting", "material": "AlSi7Mg", "temperature": 660.0},
            {"name": "mould", "material": "Cu-pure", "temperature": 150.0, "law": "rigid"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "constant", "closed": 1600.0}}],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 30.0},
    }  # fmt: skip
    state = final_state(comm, data)
    assert state.problem.mechanics is not None
    metal = state.problem.mechanics.bodies["casting"].material
    melts = metal.conditions.shares.end == 0
    in_solid_cells = metal.points.from_cells(metal.coherent) & melts
    assert comm.allreduce(int(in_solid_cells.sum())) > 0
    assert metal.thickness.normal is not None
    assert np.abs(metal.thickness.normal.x.array[melts]).max(initial=0.0) == 0.0
    assert np.abs(state.nodal("casting", "displacement")).max(initial=0.0) < 3e-4


def check_heights(made: MechanicalProblem, lower: float, upper: float, size: float) -> None:
    """Hold the vertical displacement against strains e_yy of both halves, of a size."""
    y = places(made, "casting")[:, 1]
    expected = lower * np.minimum(y, WIDTH / 2) + upper * np.maximum(y - WIDTH / 2, 0.0)
    found = motion(made, "casting")[:, 1]
    np.testing.assert_allclose(found, expected, atol=1e-4 * size * WIDTH)


def half_molten(comm, kind: tuple[str, str, str]) -> BodyMechanics:
    part = melt(comm, kind, moved(0.0, 0.0)).bodies["casting"]
    points = part.mesh.nodes.tabulate_dof_coordinates()
    temperature = np.asarray(20 + 300 * points[:, 0] / LENGTH, dtype=np.float64)
    part.update_state(temperature, below(points), 1.0)
    part.set_time(0.0)
    return part


@every_kind
def test_jacobian_of_a_body_that_is_half_molten(comm, kind):
    part = half_molten(comm, kind)
    check_derivative(comm, part, 1.0)


@every_kind
def test_jacobian_of_a_melt(comm, kind):
    made = melt(comm, kind, moved(0.0, 0.0))
    heat(made, 640.0, 0.0)
    check_derivative(comm, made.bodies["casting"], 1.0)


@pytest.mark.parametrize("kind", [KINDS[0], KINDS[2], KINDS[3]], ids="-".join)
def test_rejected_steps_and_restarts_leave_no_trace(comm, kind):
    """Trial steps that freeze and melt are undone; another problem goes on from the saved state."""
    far = moved(0.0, 0.0, 1e-3, 1e-3, 1.5e-3, 1.5e-3)
    plain, tried, late = (melt(comm, kind, far, liquid=THICK) for _ in range(3))
    steps = ((1.0, below), (2.0, below), (3.0, 1.0), (4.0, below), (5.0, 1.0))
    for time, solid in steps:
        for trial in (1.0, 0.0):
            heat(tried, STRESS_FREE, trial)
            tried.equilibrium.solve(time)
            tried.equilibrium.rewind()
        for each in (plain, tried, *((late,) if time > 4.0 else ())):
            accept(each, time, solid)
        if time == 4.0:
            restart(plain, late)
    expected = motion(plain, "casting")
    scale = np.abs(expected).max(axis=0, initial=0.0)
    for each in (tried, late):
        apart = np.abs(motion(each, "casting") - expected).max(axis=0, initial=0.0)
        assert (apart <= 1e-7 * scale).all()


def restart(one: MechanicalProblem, other: MechanicalProblem) -> None:
    """Let a problem go on from the committed state of another one on the same ranks."""
    assert isinstance(one.equilibrium, Equilibrium)
    assert isinstance(other.equilibrium, Equilibrium)
    for name, part in one.bodies.items():
        parts = part.stateful_parts()
        arrays: Arrays = {key: saved.values for key, saved in saved_parts(parts).items()}
        restore_parts(other.bodies[name].stateful_parts(), arrays)
    other.equilibrium.committed[:] = one.equilibrium.committed
    other.equilibrium.rewind()
