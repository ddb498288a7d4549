"""Cost of the coupled cylinder in space by mesh size: steps, iterations, passes, time and memory.

    bin/with-fenicsx mpirun -n 2 python3 bench/scaling.py [NODES ...] [--viscoplastic | --elastic]
        [--end S]

Runs demos/cylinder_3d.toml with about so many nodes in all (default 1300 5400 20000), without
output files; with --viscoplastic its casting flows as its database says, from the liquid on, with
--elastic it is a solid at every temperature. CPU seconds and memory are sums over the ranks; memory
is the peak of the resident sets, which never falls, so each size is best run alone:
bench/scaling.py 20000.
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
SIZES = {1300: 0.0072, 5400: 0.0042, 20000: 0.00258}
COLUMNS = (
    "nodes", "cells", "unknowns", "ranks", "steps", "cutbacks", "passes", "heat its", "mech its",
    "linear its", "frozen", "a solve", "wall s", "CPU s", "memory MB", "energy error",
    "solid at end",
)
SOLID = (
    "materials.solid.extends=Al-pure", "materials.solid.liquid=none", "bodies.0.material=solid",
    "bodies.0.law=thermo-elastic",
)  # fmt: skip
COUNTS = (
    "cutbacks", "passes", "heat_iterations", "mechanics_iterations", "linear_iterations",
    "frozen_pairs",
)  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the sizes and print a line for each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("nodes", nargs="*", type=int, default=list(SIZES))
    law = parser.add_mutually_exclusive_group()
    law.add_argument("--viscoplastic", action="store_true", help="let the casting flow")
    law.add_argument("--elastic", action="store_true", help="let it be a solid throughout")
    parser.add_argument("--end", type=float, default=90.0, help="end of the run [s]")
    wanted = parser.parse_args(arguments)
    changes = [f"time.end={wanted.end}"]
    if not wanted.viscoplastic:
        changes.append("bodies.0.law=thermo-elastic")
    if wanted.elastic:
        changes += SOLID
    show(COLUMNS)
    for nodes in wanted.nodes:
        show(measure([f"geometry.size={element_size(nodes)}", *changes]))


def element_size(nodes: int) -> float:
    """Return the element size [m] that gives about so many nodes."""
    return SIZES.get(nodes) or SIZES[5400] * (5400 / nodes) ** (1 / 3)


def measure(changes: Sequence[str]) -> tuple[str, ...]:
    """Run the case with changes `key=value`; return a line of the table."""
    comm = MPI.COMM_WORLD
    case = load_case(CASE, changes)
    begin, cpu = time.perf_counter(), time.process_time()
    simulation = Simulation.from_case(case, comm)
    counts = dict.fromkeys(COUNTS, 0)
    for state in simulation:
        for name in counts:
            counts[name] += getattr(state.counters, name)
    wall = time.perf_counter() - begin
    cpu = comm.allreduce(time.process_time() - cpu)
    memory = comm.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) / 1024
    meshes = [body.mesh.topology for body in simulation.mesh.bodies.values()]
    nodes, cells = (
        sum(mesh.index_map(dim).size_global for mesh in meshes) for dim in (0, meshes[0].dim)
    )
    mechanics = simulation.problem.mechanics
    assert mechanics is not None
    unknowns = mechanics.equilibrium.present.x.getSize()
    linear = counts["linear_iterations"] / max(counts["mechanics_iterations"], 1)
    totals = state.totals
    simulation.destroy()
    return (
        f"{nodes}", f"{cells}", f"{unknowns}", f"{comm.size}", f"{state.step}",
        *(f"{count}" for count in counts.values()), f"{linear:.1f}", f"{wall:.0f}", f"{cpu:.0f}",
        f"{memory:.0f}", f"{totals['energy_error']:.1e}", f"{totals['casting.solid_fraction']:.3f}",
    )


def show(cells: tuple[str, ...]) -> None:
    """Print a line of the table on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        print("".join(f"{cell:>13}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
