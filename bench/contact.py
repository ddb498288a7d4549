"""Cost of condensed contact in space: active-set loop, linear solves, CPU seconds and memory.

    bin/with-fenicsx mpirun -n 1 python3 bench/contact.py [TETRAHEDRA ...]

A cylinder with a liquid core in a mould, which it leaves below, where it has cooled, and which
grips it above: half of the pairs open. One step, from all pairs closed and no displacement, by the
multigrid that large cases get and at its tolerances (default 13000 40000 127000 tetrahedra). "outer
its" are linear solves, each followed by a change of the closed pairs, "most/solve" the iterations
of the worst of them. CPU seconds and memory are sums over the ranks; memory is the peak of the
resident sets, which never falls, so each size is best run alone.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.case.geometry import Geometry
from castx.contact.choice import Contact
from castx.domain.mesh import build_mesh
from castx.equilibrium.building import MechanicsSettings
from castx.equilibrium.problem import MechanicalProblem
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import SurfaceDisplacement

RADIUS, HEIGHT, WALL, FLOOR = 0.04, 0.1, 0.04, 0.02
CASTING_COOLS, MOULD_COOLS = 40.0, 180.0
SIZES = {13000: 0.0122, 40000: 0.0083, 127000: 0.00533}
COLUMNS = (
    "tetrahedra", "unknowns", "pairs", "open", "ranks", "outer its", "linear its", "most/solve",
    "building s", "solve s", "CPU s", "memory MB",
)  # fmt: skip


def metal(name: str, young: float, expansion: float, **more: object) -> Material:
    """Return a thermo-elastic material."""
    description = {
        "density": 2700.0, "heat_capacity": 1000.0, "conductivity": 100.0,
        "young_modulus": young, "poisson_ratio": 0.33, "expansion": expansion, **more,
    }  # fmt: skip
    return Material(name, MaterialDescription.read(description))


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the sizes and print a line for each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tetrahedra", nargs="*", type=int, default=list(SIZES))
    wanted = parser.parse_args(arguments).tetrahedra
    show(COLUMNS)
    for cells in wanted:
        show(measure(SIZES.get(cells) or SIZES[40000] * (40000 / cells) ** (1 / 3)))


def measure(size: float) -> tuple[str, ...]:
    """Solve one step with an element size [m]; return a line of the table."""
    comm = MPI.COMM_WORLD
    names = ["casting", "mould"]
    geometry = Geometry.model_validate({
        "generator": "cylinder_in_mould", "model": "3d", "radius": RADIUS, "height": HEIGHT,
        "wall": WALL, "floor": FLOOR, "size": size,
    })  # fmt: skip
    mesh = build_mesh(geometry, names, comm)
    alloy = metal(
        "alloy", 70e9, 2.4e-5, solidus=600.0, liquidus=601.0, latent_heat=4e5,
        liquid={"model": "viscous", "viscosity": 1e6, "coherency": 0.7},
    )  # fmt: skip
    bodies = {
        "casting": MechanicalBody(Law(alloy, 600.0), body_force=(0.0, 0.0, -2.6e4),
                                  starts_liquid=True),
        "mould": MechanicalBody(Law(metal("steel", 200e9, 1.2e-5), 200.0), "displacement"),
    }  # fmt: skip
    begin = time.process_time()
    made = MechanicalProblem(
        mesh, bodies, {"mould": [SurfaceDisplacement("base", "all")]},
        [Contact("casting", "mould")], MechanicsSettings(linear="iterative"),
    )
    freeze(made)
    ready = time.process_time()
    report = made.equilibrium.solve(1.0)
    solved = time.process_time()
    cells = sum(b.mesh.mesh.topology.index_map(3).size_global for b in made.bodies.values())
    closed = made.equilibrium.present.active.closed
    pairs, touching = comm.allreduce(np.array([len(closed), np.count_nonzero(closed)]))
    cpu = comm.allreduce(np.array([ready - begin, solved - ready]))
    memory = comm.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) / 1024
    line = (
        f"{cells}", f"{made.layout.size_global}", f"{pairs}", f"{1 - touching / pairs:.2f}",
        f"{comm.size}", f"{report.iterations}", f"{report.linear_iterations}",
        f"{max(report.linear_solves)}", f"{cpu[0]:.1f}", f"{cpu[1]:.1f}", f"{cpu.sum():.1f}",
        f"{memory:.0f}",
    )  # fmt: skip
    made.destroy()
    return line


def freeze(made: MechanicalProblem) -> None:
    """Cool the shell of the casting below, where it comes off, and the mould above, where it grips.

    The core stays liquid.
    """
    for name, part in made.bodies.items():
        points = part.mesh.points
        height = np.clip(points[:, 2] / HEIGHT, 0.0, 1.0)
        if name == "mould":
            part.update_state(200.0 - MOULD_COOLS * height, np.ones(len(points)), 1.0)
            continue
        shell = np.hypot(points[:, 0], points[:, 1]) > 0.5 * RADIUS
        cooled = 600.0 - CASTING_COOLS * (1.0 - height)
        part.update_state(cooled, np.where(shell, 1.0, 0.0), 1.0)


def show(cells: tuple[str, ...]) -> None:
    """Print a line of the table on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        print("".join(f"{cell:>12}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
