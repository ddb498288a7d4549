"""Floating motions and their springs, found with the constraints that real problems have."""

from __future__ import annotations

import gmsh
import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.supports.springs import FloatingMotions
from castx.mechanics.clamp import SurfaceClamp
from castx.tables import Table
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import (
    blocks,
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    generated,
    motion,
    places,
    problem,
    pulled,
    pushed,
)

SOLID = (70e9, 0.33)
DOWN = (0.0, -1e4)


def found(made):
    """Return the support of a problem after its solution."""
    return made.equilibrium.balance.operator.support


def free_block(comm, model="plane-strain", **load):
    mesh = generated(
        comm, model, "slab", ["casting"], length=0.04, width=0.02, size=0.005,
        **({"depth": 0.01} if model == "3d" else {}),
    )  # fmt: skip
    return problem(mesh, {"casting": body(elastic(*SOLID), **load)}, {})


@pytest.mark.parametrize(("model", "motions"), [("plane-strain", 3), ("3d", 6)])
def test_a_free_body_has_all_rigid_motions(comm, model, motions):
    """Stretched by equal and opposite tractions it moves about its middle, without spring force."""
    zeros = (0.0,) * (1 if model == "plane-strain" else 2)
    loads = (pulled("far", 70e6, *zeros), pulled("wall", -70e6, *zeros))
    made = free_block(comm, model, loads=loads)
    made.equilibrium.solve(0.0)
    assert len(found(made).motions) == motions
    assert comm.allreduce(found(made).pins.size) == motions
    x, u = places(made, "casting")[:, 0], motion(made, "casting")[:, 0]
    strain = 70e6 / SOLID[0] * ((1 - SOLID[1] ** 2) if model == "plane-strain" else 1)
    np.testing.assert_allclose(
        everywhere(comm, u), everywhere(comm, strain * (x - 0.02)), atol=1e-9 * strain
    )
    assert made.equilibrium.support_force() < 1e-8 * 70e6 * 0.02


def two_squares():
    """Draw a body of two squares with sides of 1 cm that lie 1 cm apart."""
    occ = gmsh.model.occ
    tags = [occ.addRectangle(x, 0.0, 0.0, 0.01, 0.01) for x in (0.0, 0.02)]
    occ.synchronize()
    gmsh.model.addPhysicalGroup(2, tags, name="mould")
    gmsh.model.addPhysicalGroup(1, [4], name="far")
    gmsh.model.addPhysicalGroup(1, [2], name="near")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.004)
    gmsh.model.mesh.generate(2)


@pytest.mark.ranks
def test_each_part_of_a_body_that_lies_apart_floats(comm, shared_tmp_path):
    """One part is stretched, the other without a load: neither drifts away."""
    mesh = drawn(comm, "plane-strain", ["mould"], shared_tmp_path / "apart.msh", two_squares)
    loads = (pulled("near", 70e6, 0.0), pulled("far", -70e6, 0.0))
    made = problem(mesh, {"mould": body(elastic(*SOLID), loads=loads)}, {})
    made.equilibrium.solve(0.0)
    assert len(found(made).motions) == 6
    x, u = places(made, "mould")[:, 0], motion(made, "mould")[:, 0]
    strain = 70e6 / SOLID[0] * (1 - SOLID[1] ** 2)
    expected = np.where(x < 0.015, strain * (x - 0.005), 0.0)
    np.testing.assert_allclose(u, expected, atol=1e-3 * strain * 0.005)  # weak springs: 2e-4


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_block_on_a_floor_slides_only(comm, method):
    """Its weight goes to the floor; the spring holds what gravity does not."""
    weight = 7e4
    mesh = blocks(comm, base=(0.04, 0.02), symmetry=False)
    upper = body(elastic(*SOLID), body_force=(0.0, -weight))
    made = problem(
        mesh, {"upper": upper, "base": body(elastic(*SOLID))}, {"base": [fixed("bottom", "all")]},
        [Contact("upper", "base", method)],
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    assert len(found(made).motions) == 1
    total = comm.allreduce(made.pair_values()[1].sum())
    assert total == pytest.approx(weight * 0.02 * 0.03, rel=1e-10)
    assert made.equilibrium.support_force() < 1e-8 * total
    assert abs(everywhere(comm, motion(made, "upper"))[:, 0].sum()) < 1e-10


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_pushed_block_is_held_by_the_spring_alone(comm, method):
    """Sideways nothing else can carry the push: the spring's force is the push."""
    mesh = blocks(comm, base=(0.04, 0.02), symmetry=False)
    loads = (pushed("top", 1e6), pulled("top", 1e3, 0.0))
    made = problem(
        mesh, {"upper": body(elastic(*SOLID), loads=loads), "base": body(elastic(*SOLID))},
        {"base": [fixed("bottom", "all")]}, [Contact("upper", "base", method)], tolerance=1e-8,
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    support = found(made)
    amplitude = abs(support.amplitudes(made.equilibrium.x.array_r)[0])
    assert amplitude * support.stiffness == pytest.approx(made.equilibrium.support_force())
    moved = everywhere(comm, motion(made, "upper"))[:, 0].mean()
    per_motion = np.abs(everywhere(comm, support.motions.T)).max()
    assert amplitude * support.stiffness * per_motion == pytest.approx(1e3 * 0.02, rel=1e-6)
    assert moved > 0.0


def test_symmetry_plane_and_floor_hold_a_block(comm):
    made = problem(
        blocks(comm), {n: body(elastic(*SOLID), body_force=DOWN) for n in ("upper", "base")},
        {"base": [fixed("bottom")]}, [Contact("upper", "base")],
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    assert found(made) is None
    assert made.equilibrium.support_force() == 0.0


def test_without_support_nothing_is_looked_for(comm):
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.04, width=0.02, size=0.01)
    held = {"casting": [fixed("wall", "all")]}
    made = problem(mesh, {"casting": body(elastic(*SOLID))}, held, support=False)
    made.equilibrium.solve(0.0)
    assert found(made) is None


class Springs:
    """A free chain of three masses on a line in the plane, the whole of it on every rank's own."""

    def __init__(self, comm):
        self.K = np.kron(np.array([[1.0, -1, 0], [-1, 2, -1], [0, -1, 1]]), np.diag([1.0, 0.0]))
        self.motions = np.array([[1.0, 0, 1, 0, 1, 0], [0, 1.0, 0, 1, 0, 1]])
        self.volumes = np.repeat([1.0, 2.0, 3.0], 2)


def test_motions_amplitudes_and_weights_fit_together(comm):
    """WᵀZ = 1, held motions drop out, and the springs see the mean motion."""
    springs = Springs(comm)
    mine = np.arange(6)[comm.rank :: comm.size]
    floating = FloatingMotions(
        springs.motions[:, mine], (springs.volumes * springs.motions)[:, mine], 2.0, comm
    )
    none = np.zeros(len(mine), dtype=bool)
    both = floating.find(none)
    identity = comm.allreduce(both.weights @ both.motions.T)
    np.testing.assert_allclose(identity, np.eye(2), atol=1e-14)
    along = floating.find(mine == 1)
    assert len(along.motions) == 1
    lengthwise = everywhere(comm, along.motions[:, mine % 2 == 0].ravel())
    np.testing.assert_allclose(np.abs(lengthwise), np.abs(lengthwise[0]))
    assert np.abs(along.motions[:, mine % 2 == 1]).max(initial=0.0) < 1e-14
    assert floating.find((mine == 1) | (mine == 2)) is None
    # A row u_1x - u_2x = 0 does not hold the translation, u_1x = 0 does.
    assert len(floating.find(mine == 1, np.zeros((2, 1))).motions) == 1
    row = np.array([[1.0], [0.0]]) if comm.rank == 0 else np.zeros((2, 0))
    assert floating.find(mine == 1, row) is None


def test_other_springs_hold_motions_like_constraints(comm):
    springs = Springs(comm)
    mine = np.arange(6)[comm.rank :: comm.size]
    held = np.array([[0.5], [0.0]]) if comm.rank == comm.size - 1 else np.zeros((2, 0))
    floating = FloatingMotions(
        springs.motions[:, mine], (springs.volumes * springs.motions)[:, mine], 2.0, comm, held
    )
    (across,) = floating.find(np.zeros(len(mine), dtype=bool)).motions
    assert np.abs(across[mine % 2 == 0]).max(initial=0.0) < 1e-14
    assert floating.find(mine == 1) is None


@pytest.mark.parametrize(("model", "stiffness", "motions"), [
    ("plane-strain", 1e9, 1), ("plane-strain", 0.0, 3), ("3d", 1e9, 3), ("3d", 0.0, 6),
])  # fmt: skip
def test_a_machine_holds_what_strains_its_springs(comm, model, stiffness, motions):
    """A plate behind an end of a bar leaves sliding along it; a force alone leaves all free."""
    none = Table.constant(0.0)
    made = free_block(comm, model, clamps=[SurfaceClamp("far", none, stiffness)])
    made.equilibrium.solve(0.0)
    assert len(found(made).motions) == motions


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_a_machine_holds_a_die_that_has_left_its_mould(comm, method):
    """The fluid that has blown it off is borne by the machine, none of it by supports."""
    machine, blown = SurfaceClamp("top", Table.constant(0.0), 1e9), pushed("base", 1e6)
    upper = body(elastic(*SOLID), clamps=[machine], loads=(blown,))
    made = problem(
        blocks(comm), {"upper": upper, "base": body(elastic(*SOLID))},
        {"base": [fixed("bottom")]}, [Contact("upper", "base", method)], tolerance=1e-8,
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    assert found(made) is None
    assert not everywhere(comm, made.equilibrium.active.closed).any()
    assert made.equilibrium.support_force() == 0.0
    totals = made.clamp_totals()
    assert totals["upper/top.clamp_force"] == pytest.approx(1e4, rel=1e-6)
    assert totals["upper/top.clamp_displacement"] == pytest.approx(1e-5, rel=1e-6)


@pytest.mark.ranks
def test_springs_carry_a_resultant_of_any_motion(comm):
    """The spring on the mean motion of volume V has the stiffness k V.

    Every rank has unknowns that the motion moves.
    """
    springs = Springs(comm)
    mine = np.array_split(np.arange(6), comm.size)[comm.rank]
    floating = FloatingMotions(
        springs.motions[:, mine], (springs.volumes * springs.motions)[:, mine], 2.0, comm
    )
    support = floating.find(np.zeros(len(mine), dtype=bool))
    shift = 5.0 * springs.motions[0, mine]
    total = comm.allreduce(float(springs.motions[0, mine] @ support.force(shift)))
    assert total == pytest.approx(2.0 * 6.0 * 5.0, rel=1e-12)


@pytest.mark.ranks
def test_a_rank_without_unknowns_pins_nothing(comm):
    springs = Springs(comm)
    mine = np.arange(6)[: 6 if comm.rank == comm.size - 1 else 0]
    floating = FloatingMotions(
        springs.motions[:, mine], (springs.volumes * springs.motions)[:, mine], 2.0, comm
    )
    support = floating.find(np.zeros(len(mine), dtype=bool))
    assert len(support.pins) == (2 if len(mine) else 0)
    shift = 5.0 * springs.motions[0, mine]
    total = comm.allreduce(float(springs.motions[0, mine] @ support.force(shift)))
    assert total == pytest.approx(2.0 * 6.0 * 5.0, rel=1e-12)


@pytest.mark.parametrize("sine, holds", [(1.0, True), (1e-3, True), (1e-5, False), (1e-9, False)])
def test_a_row_holds_a_motion_that_it_meets_at_a_small_angle(comm, sine, holds):
    """A wall one mil steep fixes a body; what is left of a right angle by rounding does not."""
    springs = Springs(comm)
    mine = np.arange(6)[comm.rank :: comm.size]
    floating = FloatingMotions(
        springs.motions[:, mine], (springs.volumes * springs.motions)[:, mine], 2.0, comm
    )
    row = np.array([[sine], [0.0]]) if comm.rank == 0 else np.zeros((2, 0))
    assert (floating.find(mine == 1, row) is None) == holds


def test_the_entry_that_moves_most_is_pinned(comm):
    """One that moves little would hold the motion badly; of equal ones the first is taken."""
    motion = np.array([[0.6, 0.0, 1.0, 0.0, 1.0 + 1e-9, 0.9]])
    mine = np.array_split(np.arange(6), comm.size)[comm.rank]
    floating = FloatingMotions(motion[:, mine], motion[:, mine], 2.0, comm)
    support = floating.find(np.zeros(len(mine), dtype=bool))
    assert list(everywhere(comm, mine[support.pins])) == [2]
