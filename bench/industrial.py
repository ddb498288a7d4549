"""A casting of industrial size in space: cost and balance by the number of tetrahedra.

    bin/with-fenicsx mpirun -n 2 python3 bench/industrial.py TETRAHEDRA [--law elastic | flowing]
        [--end S]

Runs the quarter cylinder of demos/cylinder_3d.toml with about so many tetrahedra in all (20,000 to
more than a million), elastic throughout or flowing from the liquid on, to a time, without output
files. The line of the table stands below its head; CPU seconds and memory are sums over the ranks,
memory the peak of their resident sets, errors the largest of all steps.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from castx.case.reading.read import load_case
from castx.process.simulation import Simulation

CASE = Path(__file__).parent.parent / "demos" / "cylinder_3d.toml"
SIZE, TETRAHEDRA = 0.0042, 24_984
"""Element size [m] that gives so many tetrahedra; their number follows its third power."""
LAWS = {
    "flowing": ("bodies.0.law=thermo-elasto-viscoplastic",),
    "elastic": (
        "materials.solid.extends=Al-pure", "materials.solid.liquid=none",
        "bodies.0.material=solid",
    ),
}  # fmt: skip
COLUMNS = (
    "tetrahedra", "unknowns", "ranks", "law", "to s", "steps", "cuts", "Newton", "a solve",
    "wall s", "CPU s", "memory MB", "force_error", "energy_error",
)  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the case and print its line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tetrahedra", type=int, help="about so many in all bodies")
    parser.add_argument("--law", choices=tuple(LAWS), default="elastic", help="of the casting")
    parser.add_argument("--end", type=float, default=90.0, help="end of the run [s]")
    asked = parser.parse_args(arguments)
    show(COLUMNS)
    show(measure(asked.tetrahedra, asked.law, asked.end))


def measure(tetrahedra: int, law: str, end: float) -> tuple[str, ...]:
    """Run the case with about so many tetrahedra; return its line."""
    size = SIZE * (TETRAHEDRA / tetrahedra) ** (1 / 3)
    case = load_case(CASE, [f"geometry.size={size}", f"time.end={end}", *LAWS[law]])
    comm, begin, cpu = MPI.COMM_WORLD, time.perf_counter(), time.process_time()
    simulation = Simulation.from_case(case, comm)
    mechanics = simulation.problem.mechanics
    assert mechanics is not None
    cuts = newton = linear = 0
    force_error = energy_error = 0.0
    for state in simulation:
        counters, errors = state.counters, mechanics.equilibrium.force_errors()
        cuts += counters.cutbacks
        newton += counters.mechanics_iterations
        linear += counters.linear_iterations
        energy_error = max(energy_error, abs(state.totals["energy_error"]))
        if state.step:
            force_error = max(force_error, *errors.values())
    wall = time.perf_counter() - begin
    cpu = comm.allreduce(time.process_time() - cpu)
    memory = comm.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) / 1024
    meshes = [body.mesh.topology for body in simulation.mesh.bodies.values()]
    cells = sum(mesh.index_map(mesh.dim).size_global for mesh in meshes)
    unknowns = mechanics.equilibrium.x.getSize()
    simulation.destroy()
    return (
        f"{cells}", f"{unknowns}", f"{comm.size}", law, f"{state.time:g}", f"{state.step}",
        f"{cuts}", f"{newton}", f"{linear / max(newton, 1):.1f}", f"{wall:.0f}", f"{cpu:.0f}",
        f"{memory:.0f}", f"{force_error:.1e}", f"{energy_error:.1e}",
    )  # fmt: skip


def show(cells: Sequence[str]) -> None:
    """Print a line of the table on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        print("".join(f"{cell:>13}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
