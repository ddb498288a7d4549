"""Matrices by block rows against those that PETSc assembles itself."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.form_rows import FormRows
from tests.castx.mechanics.lone_bodies import slab

ADDED = 3.0


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("size", [1, 2, 3, 4])
def test_block_rows_have_the_bits_of_petsc(comm, cells, size):
    mesh = slab(comm, "plane-strain", cells).mesh
    space = fem.functionspace(mesh, ("Lagrange", 1, (size,)))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    scale = fem.Constant(mesh, 1.0)
    x = ufl.SpatialCoordinate(mesh)
    mixing = ufl.as_matrix([[1.0 + i + 2.0 * j for j in range(size)] for i in range(size)])
    form = fem.form(
        scale * (1 + x[0]) * ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
        + ufl.inner(mixing * u, v) * ufl.ds
    )
    A, B, rows = create_matrix(form), create_matrix(form), FormRows(form)
    for value in (1.0, ADDED):
        scale.value = value
        A.zeroEntries()
        assemble_matrix(A, form)
        A.assemble()
        rows.assemble(B)
    assert A.norm() > 0
    B.axpy(-1.0, A)
    assert B.norm() <= 2e-15 * A.norm()
    pattern = [np.array_equal(*pair) for pair in zip(A.getRowIJ(), B.getRowIJ(), strict=True)]
    assert all(pattern)
    for matrix in (A, B):
        matrix.destroy()
