"""A form that was compiled before is the same object, one with another signature is not."""

from __future__ import annotations

from mpi4py import MPI

import dolfinx.jit
import dolfinx.mesh
import pytest
import ufl

from tests import compiled_forms


@pytest.fixture
def compiled(monkeypatch):
    """Count what reaches the compiler behind the memory."""
    reached = []

    def compiler(comm, ufl_object, *options, **more):
        reached.append((comm.size, ufl_object))
        return object()

    monkeypatch.setattr(dolfinx.jit, "ffcx_jit", compiler)
    compiled_forms.keep()
    return reached


def mass(comm: MPI.Intracomm, factor: int) -> ufl.Form:
    mesh = dolfinx.mesh.create_unit_square(comm, 2, 2)
    return factor * ufl.dx(domain=mesh)


@pytest.mark.ranks
def test_a_form_is_compiled_once_for_each_size_of_communicator(comm, compiled):
    first = dolfinx.jit.ffcx_jit(comm, mass(comm, 1))
    assert dolfinx.jit.ffcx_jit(comm.Dup(), mass(comm, 1)) is first
    assert dolfinx.jit.ffcx_jit(comm, mass(comm, 2)) is not first
    assert [size for size, _ in compiled] == [comm.size, comm.size]
    dolfinx.jit.ffcx_jit(MPI.COMM_SELF, mass(MPI.COMM_SELF, 1))
    assert len(compiled) == (2 if comm.size == 1 else 3)


@pytest.mark.serial
def test_options_make_another_form(compiled):
    form = mass(MPI.COMM_SELF, 1)
    plain = dolfinx.jit.ffcx_jit(MPI.COMM_SELF, form)
    assert dolfinx.jit.ffcx_jit(MPI.COMM_SELF, form, {"scalar_type": "float32"}) is not plain


@pytest.mark.serial
def test_what_is_no_form_is_left_to_the_compiler(compiled):
    domain = mass(MPI.COMM_SELF, 1).ufl_domain()
    for _ in range(2):
        dolfinx.jit.ffcx_jit(MPI.COMM_SELF, domain)
    assert len(compiled) == 2
