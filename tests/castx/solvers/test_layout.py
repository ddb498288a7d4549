"""The common numbering of all bodies: any rank finds any unknown."""

from petsc4py import PETSc

import numpy as np
import pytest
from dolfinx import fem

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.solvers.layout import Layout

BLOCK_SIZES = (3, 4)


@pytest.fixture(params=[0.003, 1.0], ids=["fine", "some ranks without cells"])
def bodies(request, comm):
    description = {"generator": "two_slabs", "model": "plane-strain", "size": request.param}
    description |= {"length": 0.02, "mould_length": 0.01, "width": 0.012}
    mesh = build_mesh(Geometry.model_validate(description), ["casting", "mould"], comm)
    return list(mesh.bodies.values())


@pytest.fixture
def layout(bodies, comm):
    return Layout(comm, [body.nodes.dofmap.index_map for body in bodies], BLOCK_SIZES)


def numbered(bodies):
    """One function per body whose values tell body, global node and component."""
    functions = []
    for index, (body, block_size) in enumerate(zip(bodies, BLOCK_SIZES, strict=True)):
        function = fem.Function(fem.functionspace(body.mesh, ("Lagrange", 1, (block_size,))))
        function.x.array[:] = expected(index, global_nodes(body), np.arange(block_size)).ravel()
        functions.append(function)
    return functions


def filled(layout, functions):
    """Return a vector with the owned values of one function per body."""
    vector = layout.create_vector()
    for index, function in enumerate(functions):
        part = layout.local_slice(index)
        vector.array[part] = function.x.array[: part.stop - part.start]
    return vector


def global_nodes(body):
    node_map = body.nodes.dofmap.index_map
    local = np.arange(node_map.size_local + node_map.num_ghosts, dtype=np.int32)
    return node_map.local_to_global(local)


def expected(body, nodes, components):
    return 1e6 * (body + 1) + 10.0 * nodes[:, None] + components


def everything(vector):
    """All values of a distributed vector, on every rank."""
    scatter, whole = PETSc.Scatter.toAll(vector)
    scatter.scatter(vector, whole)
    values = whole.array.copy()
    for petsc_object in (scatter, whole):
        petsc_object.destroy()
    return values


def test_sizes_and_slices_cover_the_vector(bodies, layout, comm):
    nodes = [body.nodes.dofmap.index_map for body in bodies]
    assert layout.size_local == 3 * nodes[0].size_local + 4 * nodes[1].size_local
    assert layout.size_global == 3 * nodes[0].size_global + 4 * nodes[1].size_global
    assert layout.local_slice(0) == slice(0, 3 * nodes[0].size_local)
    assert layout.local_slice(1) == slice(3 * nodes[0].size_local, layout.size_local)
    assert layout.offsets == (0, 3 * nodes[0].size_local)


def test_dofs_of_any_owner_point_at_the_right_value(bodies, layout):
    vector = filled(layout, numbered(bodies))
    values = everything(vector)
    for index, (body, block_size) in enumerate(zip(bodies, BLOCK_SIZES, strict=True)):
        nodes = np.arange(body.nodes.dofmap.index_map.size_global)
        for component in range(block_size):
            dofs = layout.dofs(index, nodes, component)
            assert dofs.dtype == np.int32
            assert np.array_equal(values[dofs], expected(index, nodes, component)[:, 0])
        mixed = nodes % block_size
        assert np.array_equal(
            layout.dofs(index, nodes, mixed), layout.dofs(index, nodes, 0) + mixed
        )
    vector.destroy()


@pytest.mark.ranks
def test_functions_come_back_with_their_ghosts(bodies, layout):
    originals, copies = numbered(bodies), numbered(bodies)
    vector = filled(layout, originals)
    for copy in copies:
        copy.x.array[:] = -1.0
    layout.to_functions(vector, copies)
    for original, copy in zip(originals, copies, strict=True):
        assert np.array_equal(original.x.array, copy.x.array)
    vector.destroy()


@pytest.mark.ranks
def test_index_sets_are_those_of_a_nest(bodies, layout, comm):
    sets = layout.index_sets()
    assert [part.getBlockSize() for part in sets] == list(BLOCK_SIZES)
    blocks = [
        PETSc.Mat().createConstantDiagonal((part.getSizes(), part.getSizes()), 1.0, comm=comm)
        for part in sets
    ]
    nest = PETSc.Mat().createNest([[blocks[0], None], [None, blocks[1]]], comm=comm)
    for ours, theirs in zip(sets, nest.getNestISs()[0], strict=True):
        assert np.array_equal(ours.indices, theirs.indices)
    for petsc_object in (nest, *blocks, *sets):
        petsc_object.destroy()
