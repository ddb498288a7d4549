from __future__ import annotations

import subprocess
import sys
from functools import partial

from petsc4py import PETSc

import numpy as np
import pytest

from castx.errors import CaseError, ConvergenceError
from castx.solvers.snes import NonlinearSolver


def residual(power, snes, x, F):
    F.array[:] = x.array_r**power - 8.0


def jacobian(power, snes, x, J, P):
    start, _ = P.getOwnershipRange()
    for k, value in enumerate(power * x.array_r ** (power - 1)):
        P[start + k, start + k] = value
    P.assemble()


def diagonal(comm, size=4):
    matrix = PETSc.Mat().createAIJ((size, size), nnz=1, comm=comm)
    matrix.setUp()
    return matrix


def solver(comm, power=3, **settings) -> tuple[NonlinearSolver, PETSc.Vec]:
    matrix = diagonal(comm)
    arguments = {"options": {"ksp_type": "preonly", "pc_type": "jacobi"}, **settings}
    made = NonlinearSolver(
        "the test problem",
        "castx_test_",
        partial(residual, power),
        partial(jacobian, power),
        vector=matrix.createVecLeft(),
        matrix=matrix,
        **arguments,
    )
    x = matrix.createVecRight()
    x.set(3.0)
    return made, x


def test_solution_and_report(comm):
    made, x = solver(comm)
    report = made.solve(x)
    assert x.array_r == pytest.approx(2.0)
    assert report.iterations == report.linear_iterations == len(report.residuals) - 1
    assert report.residuals[0] == pytest.approx(19.0 * 2.0)
    x.set(3.0)
    assert made.solve(x).residuals == report.residuals
    made.destroy()


def test_a_linear_system_with_the_present_matrix(comm):
    """Also before the first iteration, and of a matrix that has changed since the last one."""
    made, x = solver(comm)
    matrix, right = made.snes.getJacobian()[0], x.duplicate()
    right.set(6.0)
    for value in (2.0, 3.0):
        jacobian(1, made.snes, x, matrix, matrix)
        matrix.scale(value)
        made.solve_linear(right, x)
        assert x.array_r == pytest.approx(6.0 / value)
    made.destroy()


def test_options_act_under_the_prefix_and_leave_the_database(comm):
    before = PETSc.Options().getAll()
    made, x = solver(comm, options={"ksp_type": "cg", "ksp_max_it": 3, "pc_type": "none"})
    assert made.snes.ksp.getType() == "cg"
    assert made.snes.ksp.getOptionsPrefix() == "castx_test_"
    made.solve(x)
    assert PETSc.Options().getAll() == before
    made.destroy()


def test_options_of_inner_solvers_act_when_they_are_made(comm):
    made, x = solver(comm, options={"pc_type": "asm", "sub_pc_type": "jacobi"})
    made.solve(x)
    assert [inner.pc.getType() for inner in made.snes.ksp.pc.getASMSubKSP()] == ["jacobi"]
    made.destroy()


def test_options_that_the_user_had_set_come_back(comm):
    database = PETSc.Options()
    database["castx_test_ksp_type"] = "gmres"
    try:
        made, _ = solver(comm)
        assert made.snes.ksp.getType() == "preonly"
        assert database["castx_test_ksp_type"] == "gmres"
        made.destroy()
    finally:
        database.delValue("castx_test_ksp_type")


def test_failure_names_the_problem_the_reason_and_the_residuals(comm):
    made, x = solver(comm, options={"snes_max_it": 2, "ksp_type": "preonly", "pc_type": "jacobi"})
    words = r"the test problem .* max it after 2 .* 3\.800e\+01"
    with pytest.raises(ConvergenceError, match=words):
        made.solve(x)
    made.destroy()


def test_failure_of_the_linear_solver_is_named(comm):
    made, x = solver(comm, options={"ksp_type": "cg", "ksp_max_it": 1, "pc_type": "none"})
    x.setValue(0, 7.0)
    x.assemble()
    with pytest.raises(ConvergenceError, match=r"linear solve \(diverged max it\)"):
        made.solve(x)
    made.destroy()


def test_convergence_test_of_the_caller(comm):
    def twice(snes, iteration, norms):
        reasons = PETSc.SNES.ConvergedReason
        return reasons.CONVERGED_FNORM_ABS if iteration == 2 else reasons.ITERATING

    made, x = solver(comm, converged=twice)
    assert made.solve(x).iterations == 2
    made.destroy()


def test_step_rule_changes_the_step(comm):
    def half(x, y, snes):
        y.scale(0.5)
        return True

    options = {"snes_linesearch_type": "basic", "ksp_type": "preonly", "pc_type": "jacobi"}
    made, x = solver(comm, power=1, options=options, step_rule=half)
    report = made.solve(x)
    ratios = np.array(report.residuals[1:]) / np.array(report.residuals[:-1])
    assert ratios == pytest.approx(0.5)
    made.destroy()


def test_nest_of_blocks(comm):
    blocks = [diagonal(comm), diagonal(comm)]
    nest = PETSc.Mat().createNest([[blocks[0], None], [None, blocks[1]]], comm=comm)
    nest.setUp()

    def fill(snes, x, J, P):
        for k, block in enumerate(blocks):
            part = x.getSubVector(nest.getNestISs()[0][k])
            jacobian(3, snes, part, block, block)
            x.restoreSubVector(nest.getNestISs()[0][k], part)
        P.assemble()

    x = nest.createVecRight()
    x.set(3.0)
    made = NonlinearSolver(
        "the test problem",
        "castx_test_",
        partial(residual, 3),
        fill,
        vector=x.duplicate(),
        matrix=nest,
        options={
            "ksp_type": "fgmres",
            "pc_type": "fieldsplit",
            "fieldsplit_0_pc_type": "jacobi",
            "fieldsplit_1_pc_type": "jacobi",
        },
    )
    made.solve(x)
    assert x.array_r == pytest.approx(2.0)
    made.destroy()


def catch_what_a_callback_raises(where: str, raised: Exception) -> None:
    """Check that an exception of a callback of SNES comes out of a solution as it is."""

    def fail(*_: object) -> None:
        raise raised

    made, x = solver(PETSc.COMM_SELF)
    getattr(made.snes, where)(fail, *([x.duplicate()] if where == "setFunction" else []))
    with pytest.raises(type(raised), match=str(raised)) as caught:
        made.solve(x)
    assert caught.value is raised
    made.destroy()


class Raising:
    """A preconditioner that raises when it is applied."""

    def __init__(self, raised):
        self.raised = raised

    def apply(self, pc, r, z):
        raise self.raised


def catch_what_a_preconditioner_raises(where, raised):
    made, x = solver(PETSc.COMM_SELF, options={"ksp_type": "gmres", "pc_type": "python"})
    made.snes.ksp.pc.setPythonContext(Raising(raised))
    matrix, right = made.snes.getJacobian()[0], x.duplicate()
    jacobian(3, made.snes, x, matrix, matrix)
    right.set(1.0)
    with pytest.raises(type(raised), match=str(raised)) as caught:
        getattr(made, where)(*([right] if where == "solve_linear" else []), x)
    assert caught.value is raised
    made.destroy()


@pytest.mark.serial
@pytest.mark.parametrize("raised", ['ZeroDivisionError("a bug")', 'ConvergenceError("no state")'])
@pytest.mark.parametrize(
    "catch, where",
    [
        ("callback", "setFunction"),
        ("callback", "setJacobian"),
        ("preconditioner", "solve"),
        ("preconditioner", "solve_linear"),
    ],
)
def test_what_a_callback_raises_comes_out_as_it_is(catch, where, raised):
    """Sixty times in a process of its own, with garbage collected as often as can be.

    A collection on the way of an exception through petsc4py ends the process by a fault.
    """
    code = (
        "import gc\n"
        "from mpi4py import MPI\n"  # finds the MPI of wheels for petsc4py
        "from castx.errors import ConvergenceError\n"
        f"from tests.castx.solvers.test_snes import catch_what_a_{catch}_raises as catch\n"
        "gc.set_threshold(1, 1, 1)\n"
        "for _ in range(60):\n"
        f"    catch({where!r}, {raised})\n"
        "print('as it is', gc.isenabled())"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stdout) == (0, "as it is True\n"), ended.stderr


@pytest.mark.parametrize(
    "key, value, text", [("ksp_type", "foo", "KSP type foo"), ("snes_max_it", "abc", "abc")]
)
def test_options_that_petsc_does_not_take_are_refused(comm, key, value, text):
    with pytest.raises(CaseError, match=rf"test problem.*{text}.*leave it out.*{key} = '{value}'"):
        solver(comm, options={key: value})


def test_an_inner_solver_that_does_not_exist_is_refused(comm):
    options = {"ksp_type": "preonly", "pc_type": "bjacobi", "sub_pc_type": "foo"}
    made, x = solver(comm, options=options)
    with pytest.raises(CaseError, match=r"PC type foo.*sub_pc_type = 'foo'"):
        made.solve(x)
    made.destroy()
