"""The states of a case, and profiles of its bodies on all ranks."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import read_case
from castx.domain.source import gmsh_session
from castx.process.simulation import Simulation
from castx.process.state import State
from castx.ranks import on_first_rank


def states(
    comm: MPI.Intracomm, data: Mapping[str, Any], folder: Path | None = None
) -> Iterator[State]:
    """Yield the states of a run of a case, the initial one first; frees it behind the last.

    Args:
        comm: the ranks.
        data: content of a case file.
        folder: to which mesh files are relative.
    """
    simulation = Simulation.from_case(read_case(data, (folder or Path()) / "case.toml"), comm)
    try:
        yield from simulation
    finally:
        simulation.destroy()


@contextmanager
def drawn_mesh(comm: MPI.Intracomm, draw: Callable[[], None]) -> Iterator[Path]:
    """Provide a folder with `mesh.msh`, which `draw` puts into an empty gmsh model; collective."""
    made = tempfile.TemporaryDirectory(prefix="castx-") if comm.rank == 0 else None
    try:
        folder: Path = comm.bcast(Path(made.name) if made else None)
        on_first_rank(comm, lambda: _write(draw, folder / "mesh.msh"))
        yield folder
    finally:
        comm.Barrier()
        if made:
            made.cleanup()


def _write(draw: Callable[[], None], file: Path) -> None:
    with gmsh_session():
        draw()
        gmsh.write(str(file))


def owned_nodes(state: State, body: str) -> int:
    """Return the number of nodes of a body that this rank owns; they come first."""
    return int(state.mesh.bodies[body].nodes.dofmap.index_map.size_local)


def places(state: State, body: str) -> FloatArray:
    """Return the positions of all nodes of a body of all ranks, (nodes, gdim)."""
    dimension = state.mesh.parent.geometry.dim
    own = state.mesh.bodies[body].points[: owned_nodes(state, body), :dimension]
    return np.concatenate(state.mesh.comm.allgather(own))


def nodal(state: State, body: str, name: str) -> FloatArray:
    """Return a nodal field of all ranks in the order of `places`."""
    own = state.nodal(body, name)[: owned_nodes(state, body)]
    return np.concatenate(state.mesh.comm.allgather(own))


def centres(state: State, body: str) -> FloatArray:
    """Return the middles of all cells of a body of all ranks, (cells, gdim)."""
    here, own = state.mesh.bodies[body], _owned_cells(state, body)
    dimension = state.mesh.parent.geometry.dim
    middles = here.points[here.nodes.dofmap.list[:own], :dimension].mean(axis=1)
    return np.concatenate(state.mesh.comm.allgather(middles))


def cellwise(state: State, body: str, name: str) -> FloatArray:
    """Return a field of the cells of all ranks in the order of `centres`."""
    own = state.cellwise(body, name)[: _owned_cells(state, body)]
    return np.concatenate(state.mesh.comm.allgather(own))


def cell_volumes(state: State, body: str) -> FloatArray:
    """Return the volumes of the cells of a body that moves, in the order of `centres` [m³].

    Per radian in axisymmetric models, per metre of depth in other plane ones.
    """
    assert state.problem.mechanics is not None
    weights = state.problem.mechanics.bodies[body].points.weights
    return np.concatenate(
        state.mesh.comm.allgather(weights.sum(axis=1)[: _owned_cells(state, body)])
    )


def _owned_cells(state: State, body: str) -> int:
    topology = state.mesh.bodies[body].mesh.topology
    return int(topology.index_map(topology.dim).size_local)


def paired(state: State, interface: str, name: str) -> FloatArray:
    """Return a field of the pairs of all ranks."""
    return np.concatenate(state.mesh.comm.allgather(state.paired(interface, name)))


def pair_places(state: State, interface: str) -> FloatArray:
    """Return the positions of the pairs of all ranks in the order of `paired`, (pairs, gdim)."""
    return np.concatenate(state.mesh.comm.allgather(state.pairs[interface].points))


def pair_areas(state: State, interface: str) -> FloatArray:
    """Return the areas of the pairs of all ranks in the order of `paired`."""
    return np.concatenate(state.mesh.comm.allgather(state.pairs[interface].areas))


def profile(state: State, body: str, name: str) -> tuple[FloatArray, FloatArray]:
    """Return x and a field of the nodes at y = 0 of a body, along x, of all ranks."""
    points, values = places(state, body), nodal(state, body, name)
    below = np.isclose(points[:, 1], 0.0)
    order = np.argsort(points[below, 0])
    return points[below, 0][order], values[below][order]
