"""A casting of industrial size in space: cost and balance by the number of tetrahedra.

    bin/with-fenicsx mpirun -n 2 python3 bench/industrial.py TETRAHEDRA [--law elastic | flowing]
        [--end S]
    bin/with-fenicsx python3 bench/industrial.py bracket | wheel | housing | block
        [--refinement R] [--end S]

Runs the quarter cylinder of demos/cylinder_3d.toml with about so many tetrahedra in all (20,000 to
more than a million), elastic throughout or flowing from the liquid on, or a part of demos/parts
whose STEP file is drawn, its cells R times as fine as its case has them, to a time, without output
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

from castx.case.case import Case
from castx.case.reading.read import load_case
from castx.process.simulation import Simulation

DEMOS = Path(__file__).parent.parent / "demos"
PARTS = ("bracket", "wheel", "housing", "block")
SIZE, TETRAHEDRA = 0.0042, 24_984
"""Element size [m] that gives so many tetrahedra; their number follows its third power."""
LAWS = {
    "flowing": ("bodies.0.law=thermo-elasto-viscoplastic",),
    "elastic": (
        "materials.solid.extends=Al-pure", "materials.solid.liquid=none",
        "bodies.0.material=solid", "bodies.0.law=thermo-elastic",
    ),
}  # fmt: skip
COLUMNS = (
    "tetrahedra", "unknowns", "pairs", "ranks", "law", "to s", "steps", "cuts", "Newton", "a solve",
    "wall s", "CPU s", "memory MB", "force_error", "energy_error",
)  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the case and print its line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", help="about so many tetrahedra in all bodies, or a part")
    parser.add_argument("--law", choices=tuple(LAWS), default="elastic", help="of the cylinder")
    parser.add_argument("--refinement", type=float, default=1.0, help="of the cells of a part")
    parser.add_argument("--end", type=float, help="end of the run [s]")
    asked = parser.parse_args(arguments)
    if asked.what not in PARTS and not asked.what.isdecimal():
        parser.error(f"{asked.what} is no number of tetrahedra and none of {', '.join(PARTS)}")
    show(COLUMNS)
    until = [] if asked.end is None else [f"time.end={asked.end}"]
    if asked.what in PARTS:
        finer = f"geometry.refinement={asked.refinement}"
        case = load_case(DEMOS / "parts" / f"{asked.what}.toml", [finer, *until])
        show(measure(case, asked.what))
    else:
        show(measure(cylinder(int(asked.what), asked.law, until), asked.law))


def cylinder(tetrahedra: int, law: str, changes: Sequence[str] = ()) -> Case:
    """Return the cylinder with about so many tetrahedra and changes `key=value`."""
    size = SIZE * (TETRAHEDRA / tetrahedra) ** (1 / 3)
    return load_case(
        DEMOS / "cylinder_3d.toml", [f"geometry.size={size}", *LAWS[law], *changes]
    )


def measure(case: Case, law: str) -> tuple[str, ...]:
    """Run a case; return its line."""
    comm, begin, cpu = MPI.COMM_WORLD, time.perf_counter(), time.process_time()
    simulation = Simulation.from_case(case, comm)
    mechanics = simulation.problem.mechanics
    assert mechanics is not None
    cuts = newton = linear = 0
    force_error = energy_error = 0.0
    for state in simulation:
        counters, errors = state.counters, mechanics.equilibrium.shown.force_errors()
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
    unknowns = mechanics.equilibrium.present.x.getSize()
    pairs = comm.allreduce(len(mechanics.gaps.initial))
    simulation.destroy()
    return (
        f"{cells}", f"{unknowns}", f"{pairs}", f"{comm.size}", law, f"{state.time:g}",
        f"{state.step}", f"{cuts}", f"{newton}", f"{linear / max(newton, 1):.1f}", f"{wall:.0f}",
        f"{cpu:.0f}", f"{memory:.0f}", f"{force_error:.1e}", f"{energy_error:.1e}",
    )  # fmt: skip


def show(cells: Sequence[str]) -> None:
    """Print a line of the table on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        print("".join(f"{cell:>13}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
