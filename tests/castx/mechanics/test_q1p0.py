"""Q1/P0: Jacobian, patch test, and the pressures of cells that are hardly compressible."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.domain.measures import cell_measure
from castx.mechanics.q1p0 import SMALLEST_COMPRESSIBILITY, MeanDilatation
from tests.castx.mechanics.lone_bodies import (
    LENGTH,
    MELTING,
    POISSON,
    SHUT,
    WIDTH,
    YOUNG,
    alone,
    begin,
    begin_anywhere,
    check_derivative,
    inside,
    molten_ends,
    molten_quadrilaterals,
    move,
    random_field,
)
from tests.elastic_bodies import STRESS_FREE, pushed

MODELS = ("plane-strain", "generalised-plane-strain", "axisymmetric", "3d")
GRADIENT = 1e-3 * np.array([[2.0, 0.7, -0.4], [0.1, -1.2, 0.3], [0.5, -0.2, 0.9]])
SHEAR = YOUNG / (2 * (1 + POISSON))


@pytest.mark.parametrize("model", MODELS)
def test_jacobian_is_the_derivative_of_the_residual(comm, model):
    part = alone(
        comm, model, "quadrilaterals", formulation="q1p0", loads=(pushed("far", 1e6),)
    )
    begin_anywhere(part)
    check_derivative(comm, part, 1.0)


@pytest.mark.parametrize("model", ["plane-strain", "generalised-plane-strain", "axisymmetric"])
@pytest.mark.parametrize("ends", [False, True], ids=["all", "ends"])
@pytest.mark.parametrize("closed", [(), SHUT], ids=["fed", "trapped"])
def test_jacobian_of_a_liquid(comm, closed, ends, model):
    """Where it is trapped, in one full pocket or in two with a shell between them."""
    part = alone(
        comm, model, "quadrilaterals", properties=MELTING, formulation="q1p0",
        closed=closed, starts_liquid=True,
    )  # fmt: skip
    begin_anywhere(part, molten_ends(part) if ends else 0.2)
    assert part.formulation.has_pockets == bool(closed)
    check_derivative(comm, part, 1.0)


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_uniform_strain_has_hookes_stress(comm, model):
    part = alone(comm, model, "quadrilaterals", formulation="q1p0")
    begin(part, STRESS_FREE + 50.0)
    move(part, GRADIENT)
    d = part.dimension
    elastic = np.zeros((3, 3))
    elastic[:d, :d] = (GRADIENT + GRADIENT.T)[:d, :d] / 2
    elastic -= 50.0 * 2e-5 * np.eye(3)
    first = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    stress = first * np.trace(elastic) * np.eye(3) + 2 * SHEAR * elastic
    expected = stress[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    found = part.stress()
    np.testing.assert_allclose(found, [expected] * len(found), rtol=1e-9, atol=10.0)
    forces = part.residual().reshape(-1, part.block_size)[:, :d] * inside(part)[:, None]
    assert np.abs(forces).max(initial=0.0) < 1e-11 * YOUNG * 1e-3 * 0.005 ** (d - 1)


class Cells:
    """Pressures of the cells of a plane slab, with conditions as a test wants them."""

    def __init__(self, comm):
        self.part = alone(comm, "plane-strain", "quadrilaterals", formulation="displacement")
        unknowns, cells = self.part.unknowns, fem.functionspace(self.part.mesh.mesh, ("DG", 0))
        increment = unknowns.strain(ufl.TrialFunction(unknowns.space))
        dx = cell_measure(self.part.mesh, "plane-strain", 2)
        self.count = len(self.part.cell_nodes)
        self.mean = MeanDilatation(
            self.part.mesh, cells, unknowns.space, increment, dx, SHEAR
        )
        self.every_other = np.where(np.arange(self.count) % 2 == 0, -7e5, np.nan)

    def begin(self, compressibility: float, free: float = 0.0, given=None) -> None:
        every = np.full(self.count, compressibility)
        strain = np.full(self.count, free)
        given = np.full(self.count, np.nan) if given is None else given
        self.mean.begin(every, strain, given)


def test_pressure_of_a_compressible_cell(comm):
    cells = Cells(comm)
    cells.begin(1e-11, 2e-3)
    cells.mean.update(np.full(cells.count, 5e-3))
    np.testing.assert_allclose(cells.mean.pressure, 3e-3 / 1e-11, rtol=1e-12)
    assert not cells.mean.iterates


def test_pressure_of_an_incompressible_cell_grows_until_its_volume_is_right(comm):
    """Its pressure grows by dilatation/ĉ in each iteration; a rewind returns to the last commit."""
    cells, least = Cells(comm), SMALLEST_COMPRESSIBILITY / SHEAR
    cells.begin(0.0)
    assert cells.mean.iterates
    for dilatation, sum_of_all in ((3e-6, 3e-6), (1e-6, 4e-6), (0.0, 4e-6)):
        cells.mean.update(np.full(cells.count, dilatation))
        np.testing.assert_allclose(cells.mean.pressure, sum_of_all / least, rtol=1e-12)
        cells.mean.improve()
    cells.mean.commit()
    cells.mean.update(np.full(cells.count, 1e-6))
    cells.mean.improve()
    cells.mean.rewind()
    cells.mean.update(np.zeros(cells.count))
    np.testing.assert_allclose(cells.mean.pressure, 4e-6 / least, rtol=1e-12)


@pytest.mark.ranks
@pytest.mark.parametrize("compressibility", [1e-11, 0.0])
def test_trapped_cells_have_the_pressures_that_are_given_last(comm, compressibility):
    """Whatever their volumes are; they have no multiplier, and the others keep theirs."""
    cells = Cells(comm)
    cells.begin(compressibility, given=cells.every_other)
    np.testing.assert_array_equal(cells.mean.given, ~np.isnan(cells.every_other))
    least = max(compressibility, SMALLEST_COMPRESSIBILITY / SHEAR)
    for given, dilatation in ((-7e5, 1e-3), (3e5, -1e-3), (3e5, 2e-3)):
        cells.mean.give(np.where(cells.mean.given, given, np.nan))
        cells.mean.update(np.full(cells.count, dilatation))
        np.testing.assert_allclose(cells.mean.pressure[::2], given, rtol=1e-14)
        np.testing.assert_allclose(cells.mean.pressure[1::2], dilatation / least, rtol=1e-12)
    assert cells.mean.iterates == (compressibility == 0.0 and cells.count > 1)
    cells.begin(compressibility, given=np.full(cells.count, 3e5))
    assert not cells.mean.iterates


@pytest.mark.ranks
def test_tangent_is_the_derivative_of_the_forces_where_pressures_are_given_too(comm):
    """Under a uniform strain all cells dilate equally; those whose pressure is given stay put."""
    cells = Cells(comm)
    cells.begin(1e-11, given=cells.every_other)
    cells.mean.give(cells.every_other)
    forces = []
    for dilatation in (0.0, float(np.trace(GRADIENT[:2, :2]))):
        cells.mean.update(np.full(cells.count, dilatation))
        forces.append(cells.mean.forces().copy())
    begin(cells.part, STRESS_FREE)
    A = cells.part.formulation.forms.create_jacobian()
    cells.part.formulation.assemble_jacobian(A)
    A.zeroEntries()
    cells.mean.add_tangent(A)
    x, y = A.createVecs()
    move(cells.part, GRADIENT)
    x.array[:] = cells.part.solution.x.array[: x.getLocalSize()]
    A.mult(x, y)
    size = comm.allreduce(float(np.abs(forces[1]).max(initial=0.0)), op=MPI.MAX)
    np.testing.assert_allclose(y.array_r, forces[1] - forces[0], atol=1e-10 * size)
    for item in (A, x, y):
        item.destroy()


@pytest.mark.ranks
def test_work_of_the_pressures_is_that_on_the_change_of_volume(comm):
    """For u = A x and one pressure p the work is p tr(A) V."""
    cells = Cells(comm)
    cells.begin(1e-11)
    cells.mean.update(np.full(cells.count, 2e-3))
    move(cells.part, GRADIENT)
    forces = cells.mean.forces()
    work = comm.allreduce(forces @ cells.part.solution.x.array[: len(forces)])
    expected = 2e8 * np.trace(GRADIENT[:2, :2]) * LENGTH * WIDTH
    assert work == pytest.approx(expected, rel=1e-12)
    volumes = cells.mean.forces_of(np.ones(cells.count))
    change = comm.allreduce(volumes @ cells.part.solution.x.array[: len(forces)])
    assert change == pytest.approx(expected / 2e8, rel=1e-12)
    np.testing.assert_array_equal(cells.mean.forces(), forces)


def test_state_of_the_pressures_comes_back(comm):
    cells, other = Cells(comm), Cells(comm)
    cells.begin(0.0)
    cells.mean.update(1e-6 * np.arange(cells.count))
    cells.mean.commit()
    saved = {name: part.values for name, part in cells.mean.saved().items()}
    assert list(saved) == ["multiplier"]
    other.begin(0.0)
    other.mean.restore(saved)
    np.testing.assert_array_equal(other.mean.pressure, cells.mean.pressure)
    for each in (cells, other):
        each.mean.update(np.full(cells.count, 1e-7))
    np.testing.assert_array_equal(other.mean.pressure, cells.mean.pressure)


def test_multipliers_make_a_liquid_keep_its_volume(comm):
    """Each turn of the multipliers divides what is left of the dilatation by a large factor."""
    part = molten_quadrilaterals(comm)
    part.solution.x.array[:] = 1e-6 * random_field(part, 1.7)
    first = part.stress()[:, :3].mean(axis=1)
    assert part.improve_pressures()
    second = part.stress()[:, :3].mean(axis=1)
    np.testing.assert_allclose(second, 2 * first, rtol=1e-9, atol=1e-6 * np.abs(first).max())
