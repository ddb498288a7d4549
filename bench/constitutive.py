"""Cost of the constitutive law: return mapping and tangent as a share of a mechanics iteration.

    bin/with-fenicsx python3 bench/constitutive.py [TETRAHEDRA ...]

A block of about so many tetrahedra (default 20000 60000) is stretched in two steps until all of it
flows, with linear hardening (closed form) and with Voce's hardening and Perzyna's overstress (a
scalar equation at each point). CPU seconds of one Newton iteration of the second step, assembly and
solution: all of it, and what takes the unknowns to strains, stresses and tangent, which happens in
each evaluation of the residual. Mixed formulation, default tolerance, multigrid.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.case.geometry import Geometry
from castx.domain.mesh import CastingMesh, build_mesh
from castx.equilibrium.building import MechanicsSettings
from castx.equilibrium.problem import MechanicalProblem
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table

ELASTIC = {
    "density": 2700.0, "heat_capacity": 1e3, "conductivity": 100.0,
    "young_modulus": 60e9, "poisson_ratio": 0.33, "yield_stress": 60e6,
}  # fmt: skip
LAWS: dict[str, dict[str, Any]] = {
    "thermo-elasto-plastic": {"hardening": 1e9},
    "thermo-elasto-viscoplastic": {
        "hardening": {"saturation": 40e6, "rate": 20.0}, "viscosity": 2e7, "exponent": 5.0,
    },
}  # fmt: skip
LENGTH, STRAIN = 0.2, 0.01
COLUMNS = (
    "tetrahedra", "law", "flowing", "iterations", "linear its", "updates", "CPU s/it", "law s/it",
    "share",
)  # fmt: skip


class Stopwatch:
    """Counts the calls of a function and the CPU seconds they take."""

    def __init__(self, function: Callable[..., None]) -> None:
        self._function = function
        self.calls, self.seconds = 0, 0.0

    def __call__(self, *arguments: Any) -> None:
        """Call the function."""
        begin = time.process_time()
        self._function(*arguments)
        self.calls, self.seconds = self.calls + 1, self.seconds + time.process_time() - begin


def main(arguments: Sequence[str] | None = None) -> None:
    """Run all sizes and laws and print a line for each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tetrahedra", nargs="*", type=int, default=[20000, 60000])
    wanted = parser.parse_args(arguments).tetrahedra
    show(COLUMNS)
    for cells in wanted:
        mesh = block(cells)
        for law in LAWS:
            show(measure(mesh, law))


def block(cells: int) -> CastingMesh:
    """Return a block of about so many tetrahedra; a cube of edge size is cut into six."""
    count = (cells / 12) ** (1 / 3)  # edges across; it is twice as long
    width = LENGTH / 2
    sizes = {"length": LENGTH, "width": width, "depth": width, "size": width / round(count)}
    description = {"generator": "slab", "model": "3d", **sizes}
    return build_mesh(Geometry.model_validate(description), ["casting"], MPI.COMM_WORLD)


def measure(mesh: CastingMesh, law: str) -> tuple[str, ...]:
    """Stretch the block, clamped at one end, in two steps; return a line of the table."""
    comm = mesh.comm
    description = MaterialDescription.read({**ELASTIC, **LAWS[law]})
    body = MechanicalBody(Law(Material("metal", description), 20.0, law))
    pull = Table.from_points([[0.0, 0.0], [1.0, LENGTH * STRAIN]])
    held = [
        SurfaceDisplacement("wall", "all", Table.constant(0.0)),
        SurfaceDisplacement("far", "x", pull),
    ]
    settings = MechanicsSettings(linear="iterative")
    problem = MechanicalProblem(mesh, {"casting": body}, {"casting": held}, [], settings)
    part, equilibrium = problem.bodies["casting"], problem.equilibrium
    nodes = len(part.mesh.nodes.tabulate_dof_coordinates())
    watch = Stopwatch(part.update_points)
    part.update_points = watch  # type: ignore[method-assign]
    for end in (0.5, 1.0):
        part.update_state(np.full(nodes, 20.0), np.ones(nodes), 0.5)
        before = part.material.history.equivalent
        watch.calls, watch.seconds = 0, 0.0
        begin = time.process_time()
        report = equilibrium.solve(end)
        spent = time.process_time() - begin
        updates, own = watch.calls, watch.seconds
        equilibrium.commit()
    flowed = part.material.history.equivalent > before
    flowing = comm.allreduce(int(flowed.sum())) / comm.allreduce(len(flowed))
    equilibrium.destroy()
    spent, own = (comm.allreduce(seconds) / report.iterations for seconds in (spent, own))
    cells = comm.allreduce(part.mesh.mesh.topology.index_map(3).size_local)
    return (
        f"{cells}", law.removeprefix("thermo-elasto-"), f"{flowing:.3f}", f"{report.iterations}",
        f"{report.linear_iterations}", f"{updates}", f"{spent:.2f}", f"{own:.3f}",
        f"{100 * own / spent:.1f} %",
    )


def show(cells: tuple[str, ...]) -> None:
    """Print a line of the table on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        print("".join(f"{cell:>13}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
