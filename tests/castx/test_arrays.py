"""The types of arrays are those of the numbers that DOLFINx and PETSc take and return."""

from typing import get_args

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import pytest
from dolfinx import fem, mesh

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray

pytestmark = pytest.mark.serial


def dtype(array_type) -> np.dtype:
    """Return the type of the numbers of an array type."""
    numbers = get_args(array_type)[-1]  # dtype[type]; since numpy 2.5 the type itself
    return np.dtype(*(get_args(numbers) or (numbers,)))


def test_types_are_those_of_dolfinx_and_petsc():
    domain = mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
    space = fem.functionspace(domain, ("Lagrange", 1))
    numbers = space.dofmap.list
    assert dtype(IntArray) == numbers.dtype == PETSc.IntType
    assert dtype(LongArray) == space.dofmap.index_map.local_to_global(numbers.ravel()).dtype
    assert dtype(FloatArray) == domain.geometry.x.dtype == PETSc.ScalarType
    assert dtype(BoolArray) == (domain.geometry.x > 0).dtype
