"""The cylinder of cylinder.toml driven from Python: the run ends as soon as the casting is solid.

mpirun -n 2 python3 demos/cylinder.py
"""

from pathlib import Path

from mpi4py import MPI

import castx

comm = MPI.COMM_WORLD
case = castx.load_case(
    Path(__file__).with_name("cylinder.toml"),
    overrides=["geometry.size=5e-3", 'output.folder="results/cylinder_driver"'],
)
simulation = castx.Simulation.from_case(case, comm)

with castx.ResultsWriter(case, simulation.mesh, simulation.pairs) as results:
    for state in simulation:
        results.write(state)
        solid = state.totals["casting.solid_fraction"]
        gap = state.totals["casting/mould.mean_gap"]
        if comm.rank == 0:
            print(f"{state.time:7.2f} s  solid {solid:6.1%}  mean gap {1e6 * gap:6.1f} µm")
        if solid > 1.0 - 1e-9:
            break

if comm.rank == 0:
    print(f"solid after {state.time:.1f} s")
