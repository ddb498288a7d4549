"""Cost of freezing inside cells: CPU seconds of iterations against those of freezing at nodes.

    bin/with-fenicsx python3 bench/freezing.py [TETRAHEDRA] [--law LAW] [--end S]

Runs the quarter cylinder of demos/cylinder_3d.toml, its casting AlSi7Mg, with about so many
tetrahedra (default 25000) at default settings but for `freezing` of the casting, "nodes" and then
"cells". The runs take steps of their own, and so a line counts their iterations and gives what one
costs in ms: heat, its residual and Jacobian for an iteration of heat, the law for a pass, the
mechanics, its residual and its matrix for an iteration of Newton's method. The last line is the
cost of the second run with the counts of the first one, over that of the first one.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from castx.case.case import Case
from castx.case.reading.read import load_case
from castx.coupling.step import CoupledProblem
from castx.equilibrium.equilibrium import Equilibrium
from castx.equilibrium.forces import MomentumBalance
from castx.heat.balance import HeatBalance
from castx.heat.problem import HeatProblem
from castx.process.simulation import Simulation

CASE = Path(__file__).parent.parent / "demos" / "cylinder_3d.toml"
SIZE, TETRAHEDRA = 0.0042, 24_984
"""Element size [m] that gives so many tetrahedra; their number follows its third power."""
PLACES = ("nodes", "cells")
COUNTS = ("passes", "heat_iterations", "mechanics_iterations", "linear_iterations")
WATCHED: dict[str, tuple[type, str, str]] = {
    "heat": (HeatProblem, "advance", "heat_iterations"),
    "its residual": (HeatBalance, "fill_residual", "heat_iterations"),
    "its Jacobian": (HeatBalance, "assemble_jacobian", "heat_iterations"),
    "law": (CoupledProblem, "_update_bodies", "passes"),
    "mechanics": (Equilibrium, "solve", "mechanics_iterations"),
    "residual": (MomentumBalance, "residual", "mechanics_iterations"),
    "matrix": (MomentumBalance, "update_matrix", "mechanics_iterations"),
}
"""What is watched: a method, and the count of a run over which its CPU seconds are divided."""
WHOLE = ("heat", "law", "mechanics")
"""What makes up a run, but for its steps and their output."""


class Watch:
    """CPU seconds that a method takes.

    Args:
        owner: class of the method.
        name: of the method.
    """

    def __init__(self, owner: type, name: str) -> None:
        self.seconds = 0.0
        method: Callable[..., Any] = getattr(owner, name)

        def watched(*arguments: Any, **named: Any) -> Any:
            begin = time.process_time()
            try:
                return method(*arguments, **named)
            finally:
                self.seconds += time.process_time() - begin

        setattr(owner, name, watched)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run both and print their lines."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tetrahedra", nargs="?", type=int, default=TETRAHEDRA)
    parser.add_argument("--law", default="thermo-elasto-viscoplastic", help="of the casting")
    parser.add_argument("--end", type=float, default=24.0, help="end of the runs [s]")
    asked = parser.parse_args(arguments)
    watches = {name: Watch(owner, method) for name, (owner, method, _) in WATCHED.items()}
    show(
        ("freezing", "cells", "steps", "passes", "heat its", "Newton", "linear", "CPU s", *WATCHED)
    )
    runs = [measure(cylinder(place, asked), watches) for place in PLACES]
    counts = runs[0][0]
    first, second = (
        sum(counts[WATCHED[name][2]] * each[name] for name in WHOLE) for _, each in runs
    )
    if MPI.COMM_WORLD.rank == 0:
        print(f"with the counts of {PLACES[0]}: {second / first:.3f} times as dear")


def cylinder(place: str, asked: argparse.Namespace) -> Case:
    """Return the case of a setting."""
    size = SIZE * (TETRAHEDRA / asked.tetrahedra) ** (1 / 3)
    changes = {
        "bodies.0.material": "AlSi7Mg", "bodies.0.freezing": place, "bodies.0.law": asked.law,
        "geometry.size": size, "time.end": asked.end,
    }  # fmt: skip
    return load_case(CASE, [f"{key}={value}" for key, value in changes.items()])


def measure(case: Case, watches: dict[str, Watch]) -> tuple[dict[str, int], dict[str, float]]:
    """Run a case and print its line; return its counts, and seconds for each of them."""
    comm = MPI.COMM_WORLD
    simulation = Simulation.from_case(case, comm)
    counts = dict.fromkeys(COUNTS, 0)
    for watch in watches.values():
        watch.seconds = 0.0
    begin = time.process_time()
    for state in simulation:
        for name in counts:
            counts[name] += getattr(state.counters, name)
    spent = comm.allreduce(time.process_time() - begin)
    meshes = [body.mesh.topology for body in simulation.mesh.bodies.values()]
    cells = sum(mesh.index_map(mesh.dim).size_global for mesh in meshes)
    each = {
        name: comm.allreduce(watch.seconds) / max(counts[WATCHED[name][2]], 1)
        for name, watch in watches.items()
    }
    simulation.destroy()
    show((
        case.bodies[0].freezing, f"{cells}", f"{state.step}",
        *(f"{count}" for count in counts.values()),
        f"{spent:.1f}", *(f"{1e3 * seconds:.2f}" for seconds in each.values()),
    ))  # fmt: skip
    return counts, each


def show(cells: Sequence[str]) -> None:
    """Print a line of the table on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        print("".join(f"{cell:>14}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
