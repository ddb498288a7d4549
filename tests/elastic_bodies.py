"""Elastic bodies in contact, made without a case, and what tests read from them on all ranks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.case.geometry import Geometry
from castx.contact.choice import Contact
from castx.domain.mesh import CastingMesh, build_mesh
from castx.domain.source import gmsh_session
from castx.equilibrium.building import MechanicsSettings
from castx.equilibrium.problem import MechanicalProblem
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody, SurfaceLoad
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table

STRESS_FREE = 20.0


def generated(
    comm: MPI.Intracomm, model: str, generator: str, bodies: Sequence[str], **arguments: Any
) -> CastingMesh:
    """Return the mesh of a generator."""
    description = {"generator": generator, "model": model, **arguments}
    return build_mesh(Geometry.model_validate(description), bodies, comm)


def drawn(
    comm: MPI.Intracomm, model: str, bodies: Sequence[str], file: Path, draw: Callable[[], None]
) -> CastingMesh:
    """Return the mesh that `draw` puts into an empty gmsh model, through a .msh file."""
    if comm.rank == 0:
        with gmsh_session():
            draw()
            gmsh.write(str(file))
    comm.Barrier()
    return build_mesh(Geometry.model_validate({"file": file, "model": model}), bodies, comm)


def blocks(
    comm: MPI.Intracomm,
    model: str = "plane-strain",
    upper: Sequence[float] = (0.02, 0.03),
    base: Sequence[float] = (0.02, 0.02),
    size: float = 0.005,
    symmetry: bool = True,
) -> CastingMesh:
    """Return the block "upper" on the block "base"."""
    if model == "3d":
        upper, base = (*upper[:2], 0.01), (*base[:2], base[0] / upper[0] * 0.01)
    return generated(
        comm, model, "stacked_blocks", ["upper", "base"],
        upper=list(upper), base=list(base), size=size, symmetry=symmetry,
    )  # fmt: skip


def elastic(young: Any, poisson: Any, expansion: float = 0.0, **properties: Any) -> Material:
    """Return a thermo-elastic material; a Poisson ratio of 0.5 makes it incompressible."""
    incompressible = poisson == 0.5
    description = MaterialDescription.read(
        {
            "density": 1.0,
            "heat_capacity": 1.0,
            "conductivity": 1.0,
            "young_modulus": young,
            "poisson_ratio": 0.3 if incompressible else poisson,
            "expansion": expansion,
            **properties,
        }
    )
    if incompressible:
        description = description.model_copy(update={"poisson_ratio": Table.constant(0.5)})
    return Material("test", description)


def body(
    material: Material, stress_free: float = STRESS_FREE, **description: Any
) -> MechanicalBody:
    """Return the mechanical description of a body."""
    return MechanicalBody(Law(material, stress_free), **description)


def pushed(surface: str, pressure: float) -> SurfaceLoad:
    """Return a constant pressure on a surface."""
    return SurfaceLoad(surface, pressure=Table.constant(pressure))


def pulled(surface: str, *traction: float) -> SurfaceLoad:
    """Return a constant traction on a surface."""
    return SurfaceLoad(surface, traction=tuple(Table.constant(t) for t in traction))


def fixed(surface: str, direction: str = "normal", value: float = 0.0) -> SurfaceDisplacement:
    """Return a prescribed displacement."""
    return SurfaceDisplacement(surface, direction, Table.constant(value))


def problem(
    mesh: CastingMesh,
    bodies: Mapping[str, MechanicalBody],
    displacements: Mapping[str, Sequence[SurfaceDisplacement]],
    contacts: Sequence[Contact] = (),
    **settings: Any,
) -> MechanicalProblem:
    """Return a problem to be solved to round-off, at the stress-free temperature."""
    tight = MechanicsSettings(**{"tolerance": 1e-12, "linear": "direct", **settings})
    made = MechanicalProblem(mesh, bodies, displacements, contacts, tight)
    for name, part in made.bodies.items():
        nodes = len(part.mesh.parent_vertices)
        solid = 0.0 if bodies[name].starts_liquid else 1.0
        part.update_state(np.full(nodes, STRESS_FREE), np.full(nodes, solid), 1.0)
    return made


def heat(
    made: MechanicalProblem,
    temperature: float | Callable[[FloatArray], FloatArray],
    solid_fraction: float | Callable[[FloatArray], FloatArray] = 1.0,
    step: float = 1.0,
) -> None:
    """Give all bodies a temperature [°C] and solid fraction, numbers or functions of the place."""
    for part in made.bodies.values():
        points = part.mesh.nodes.tabulate_dof_coordinates()[:, : part.dimension]
        values, fractions = (
            given(points) if callable(given) else np.full(len(points), given)
            for given in (temperature, solid_fraction)
        )
        part.update_state(values, fractions, step)


def everywhere(comm: MPI.Intracomm, values: FloatArray) -> FloatArray:
    """Return the rows of all ranks."""
    return np.concatenate(comm.allgather(values))


def places(made: MechanicalProblem, name: str) -> FloatArray:
    """Return the positions of the owned nodes of a body, (owned, dimension)."""
    part = made.bodies[name]
    owned = part.space.dofmap.index_map.size_local
    return part.mesh.nodes.tabulate_dof_coordinates()[:owned, : part.dimension]


def motion(made: MechanicalProblem, name: str) -> FloatArray:
    """Return displacement and pressure at the owned nodes of a body, (owned, block size)."""
    part = made.bodies[name]
    owned = part.space.dofmap.index_map.size_local
    values = part.solution.x.array.reshape(-1, part.block_size)[:owned].copy()
    if part.unknowns.pressure_component is not None:
        values[:, part.unknowns.pressure_component] *= part.unknowns.pressure_scale
    return values


def at(comm: MPI.Intracomm, made: MechanicalProblem, name: str, *place: float) -> FloatArray:
    """Return displacement and pressure at the node of a body next to a place, on all ranks."""
    points = everywhere(comm, places(made, name))
    distance = np.linalg.norm(points - np.array(place), axis=1)
    assert distance.min() < 1e-6 * np.ptp(points, axis=0).max(), "no node there"
    return everywhere(comm, motion(made, name))[np.argmin(distance)]


def pressures(comm: MPI.Intracomm, made: MechanicalProblem) -> FloatArray:
    """Return the contact pressures of all pairs of all ranks [Pa]."""
    return everywhere(comm, made.pair_values()[1] / made.gaps.areas)


def gaps(comm: MPI.Intracomm, made: MechanicalProblem) -> FloatArray:
    """Return the gaps of all pairs of all ranks [m]."""
    return everywhere(comm, made.pair_values()[0])


def stresses(comm: MPI.Intracomm, made: MechanicalProblem, name: str) -> FloatArray:
    """Return the stresses of the owned cells of a body of all ranks, (cells, 6)."""
    part = made.bodies[name]
    cells = part.mesh.mesh.topology.index_map(part.mesh.mesh.topology.dim).size_local
    return everywhere(comm, part.stress()[:cells])


def centres(comm: MPI.Intracomm, made: MechanicalProblem, name: str) -> FloatArray:
    """Return the midpoints of the cells of `stresses`, (cells, dimension)."""
    part = made.bodies[name]
    points = part.mesh.nodes.tabulate_dof_coordinates()[:, : part.dimension]
    cells = part.mesh.mesh.topology.index_map(part.mesh.mesh.topology.dim).size_local
    return everywhere(comm, points[part.cell_nodes[:cells]].mean(axis=1))


def sorted_by_place(points: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return points and rows of values in an order that only the places decide."""
    scale = np.abs(points).max()
    order = np.lexsort(np.round(points / scale, 9).T)
    return points[order], values[order]


def normal_forces(made, number=0):
    """Return the contact forces of an interface along the normals of its pairs [N], (pairs,)."""
    return np.sum(made.contact_states()[number].force * made.pairs[number].normals, axis=1)
