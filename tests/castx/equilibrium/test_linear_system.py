"""Elimination of held unknowns and floating motions against dense solutions; inner solvers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.linear_system import SLOW, SystemPreconditioner, masked
from castx.equilibrium.problem import MechanicalProblem
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    pressures,
    problem,
    pulled,
    pushed,
)


def floating_block(comm, method: str = "condensed", **settings) -> MechanicalProblem:
    """Return a solved block that slides on its base, stiff springs under a soft law, with GLS."""
    bodies = {
        "upper": body(elastic(7.0, 0.33), loads=(pushed("top", 0.1),), stabilisation="gls"),
        "base": body(elastic(70.0, 0.33), stabilisation="gls"),
    }
    mesh = blocks(comm, symmetry=False, size=0.01)
    made = problem(
        mesh, bodies, {"base": [fixed("bottom", "all")]}, [Contact("upper", "base", method)],
        **settings,
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    return made


def dense_operator(comm, made: MechanicalProblem) -> np.ndarray:
    """Return the matrix of the operator, all rows on all ranks."""
    equilibrium = made.equilibrium.present
    x, y = equilibrium.x.duplicate(), equilibrium.x.duplicate()
    first, last = x.getOwnershipRange()
    columns = []
    for j in range(x.getSize()):
        x.set(0.0)
        if first <= j < last:
            x.array[j - first] = 1.0
        equilibrium.balance.operator.mult(None, x, y)
        columns.append(everywhere(comm, y.array_r.copy()))
    return np.array(columns).T


@pytest.mark.parametrize("method", AT_ONCE)
def test_springs_and_held_unknowns_are_eliminated_exactly(comm, method):
    made = floating_block(comm, method)
    equilibrium = made.equilibrium
    assert len(equilibrium.balance.operator.support.motions) == 1
    preconditioner = equilibrium._procedure._preconditioner.chosen
    preconditioner.discard()
    preconditioner.refresh(0)
    r, z = equilibrium.x.duplicate(), equilibrium.x.duplicate()
    first, last = r.getOwnershipRange()
    r.array[:] = np.cos(0.9 * np.arange(first, last))
    preconditioner.apply(r, z)
    expected = np.linalg.solve(dense_operator(comm, made), everywhere(comm, r.array_r.copy()))
    found = everywhere(comm, z.array_r.copy())
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())
    held = everywhere(comm, equilibrium.balance.operator.constrained)
    stiffness = equilibrium.balance.operator.stiffness
    np.testing.assert_allclose(
        found[held], everywhere(comm, r.array_r.copy())[held] / stiffness, rtol=1e-12
    )


@pytest.mark.ranks
def test_only_a_set_up_that_failed_or_fell_behind_is_done_anew(comm):
    equilibrium = floating_block(comm).equilibrium
    preconditioner = equilibrium._procedure._preconditioner.chosen
    inner, found = preconditioner._inner, []
    inner.set_up = lambda matrix, constrained, anew: found.append(anew)
    preconditioner.discard()
    for iterations in (0, 5, 5):  # fresh, its first solve, and no reason for another set-up
        preconditioner.refresh(iterations)
    assert found == [True]
    preconditioner.expire()
    preconditioner.refresh(5)
    preconditioner.refresh(5)
    assert found == [True, False]
    preconditioner.refresh(20)
    assert found == [True, False, True]
    del inner.set_up


def test_operator_holds_and_supports(comm):
    """Held rows are those of the identity; the springs act on the floating motion alone."""
    made = floating_block(comm)
    A, operator = dense_operator(comm, made), made.equilibrium.balance.operator
    held = everywhere(comm, operator.constrained)
    identity = operator.stiffness * np.eye(len(A))
    np.testing.assert_array_equal(A[held], identity[held])
    mode = everywhere(comm, operator.support.motions[0].copy())
    force = A @ mode
    weights = everywhere(comm, operator.support.weights[0].copy())
    expected = operator.support.stiffness * weights
    np.testing.assert_allclose(
        force[~held], expected[~held], atol=1e-10 * operator.stiffness * np.abs(mode).max()
    )


def test_masked_matrix_keeps_the_rest(comm):
    made = floating_block(comm)
    A = made.equilibrium.balance.operator.matrix
    first, last = A.getOwnershipRange()
    held = np.arange(first, last) % 3 == 0

    def dense(matrix):
        return np.vstack(comm.allgather(matrix.convert("dense").getDenseArray().copy()))

    original, found = dense(A), dense(masked(A, held))
    chosen = np.arange(len(original)) % 3 == 0
    rest = np.ix_(~chosen, ~chosen)
    np.testing.assert_array_equal(found[rest], original[rest])
    assert np.all(found[np.ix_(chosen, ~chosen)] == 0.0)
    assert np.all(found[np.ix_(~chosen, chosen)] == 0.0)
    own = np.diag(found)[chosen]
    assert np.all(found[np.ix_(chosen, chosen)] == np.diag(own))
    np.testing.assert_allclose(own, np.abs(np.diag(original)[~chosen]).mean(), rtol=1e-12)


def hot_cup(comm, method: str, linear: str, formulation: str) -> MechanicalProblem:
    mesh = generated(
        comm, "3d", "cylinder_in_mould", ["casting", "mould"],
        radius=0.03, height=0.04, wall=0.01, floor=0.01, size=0.008, sector="quarter",
    )  # fmt: skip
    bodies = {
        "casting": body(elastic(70e9, 0.33, 2e-5), formulation=formulation),
        "mould": body(elastic(200e9, 0.3, 1e-5), formulation="displacement"),
    }
    made = problem(
        mesh, bodies, {"mould": [fixed("base")]}, [Contact("casting", "mould", method)],
        linear=linear, tolerance=1e-9,
    )  # fmt: skip
    heat(made, lambda x: 20 + 3e3 * x[:, 2] + 3e3 * x[:, 0])
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.sampled
@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
@pytest.mark.parametrize("method", AT_ONCE)
def test_direct_and_iterative_solvers_agree(comm, method, formulation):
    direct, iterative = (hot_cup(comm, method, k, formulation) for k in ("direct", "iterative"))
    expected = pressures(comm, direct)
    assert 0 < np.count_nonzero(expected) < len(expected)
    np.testing.assert_allclose(pressures(comm, iterative), expected, atol=1e-6 * expected.max())
    for name in direct.bodies:
        u = everywhere(comm, motion(direct, name)[:, :3])
        np.testing.assert_allclose(
            everywhere(comm, motion(iterative, name)[:, :3]), u, atol=1e-6 * np.abs(u).max()
        )


def test_options_reach_the_solvers(comm):
    """A PETSc option under the prefix changes the solver: Newton stops after one iteration."""
    with pytest.raises(Exception, match="did not converge: diverged max it after 1 iterations"):
        problem_with_one_iteration(comm)


def problem_with_one_iteration(comm) -> None:
    bodies = {
        "upper": body(elastic(7e9, 0.33), loads=(pushed("top", 1e6), pulled("side", 2e5, 0.0))),
        "base": body(elastic(70e9, 0.33)),
    }
    made = problem(
        blocks(comm, symmetry=False), bodies,
        {"base": [fixed("bottom", "all")], "upper": [fixed("top", "x")]},
        [Contact("upper", "base")], options={"snes_max_it": 1},
    )  # fmt: skip
    made.equilibrium.solve(0.0)


class Inner:
    """Notes what is asked of an inner solver."""

    prefix, is_exact, most_changed = "", False, 0
    defaults: Mapping[str, object] = {}

    def __init__(self, name: str, said: list[str]) -> None:
        self.name, self.said = name, said

    def set_up(self, matrix, constrained, anew=False) -> None:
        self.said.append(f"{self.name} {'anew' if anew else 'as it is'}")

    def destroy(self) -> None:
        self.said.append(f"{self.name} ends")


@pytest.mark.ranks
def test_another_solver_takes_over_where_one_is_slow_with_a_set_up_of_its_own(comm):
    """Not where a set-up has grown old, and not behind the last one."""
    made, said = floating_block(comm), []
    operator = made.equilibrium.balance.operator
    solvers = [Inner("first", said), Inner("second", said)]
    preconditioner = SystemPreconditioner(operator, solvers, comm)
    for iterations in (0, SLOW, SLOW + 1, 2 * SLOW, 2 * SLOW, 2 * SLOW + 1):
        preconditioner.refresh(iterations)
        said.append(str(iterations))
    preconditioner.destroy()
    assert said == [
        "first as it is", "0", str(SLOW), str(SLOW + 1), "first anew", str(2 * SLOW),
        "first ends", "second anew", str(2 * SLOW), str(2 * SLOW + 1), "second ends",
    ]  # fmt: skip


@pytest.mark.ranks
def test_a_constraint_that_changes_on_one_rank_outdates_the_set_up_of_all(comm):
    made, said = floating_block(comm), []
    operator = made.equilibrium.balance.operator
    preconditioner = SystemPreconditioner(operator, [Inner("one", said)], comm)
    for _ in range(2):
        preconditioner.refresh(0)
    assert said == ["one as it is"]
    if comm.rank == comm.size - 1:
        operator.constrained[0] = ~operator.constrained[0]
    preconditioner.refresh(0)
    assert said == ["one as it is"] * 2
    preconditioner.destroy()
