"""What does sand that yields cost beside rigid sand, and which stress does iron keep in it?

    bin/with-fenicsx python3 bench/sand.py [LAW ...] [--size MM]

A ring of GJL-250 is poured round a hollow core of sand-silica and cools for an hour, once for each
law of the sand: drucker-prager and rigid unless said otherwise. Prints steps, cuts, Newton's
iterations and the largest equivalent stress of the ring at the end beside its strength.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np

from castx.case.reading.read import read_case
from castx.materials.lookup import find_material
from castx.process.simulation import Simulation

LAWS = ("drucker-prager", "rigid")


def casting(law: str, size: float = 3e-3, end: float = 3600.0) -> dict[str, Any]:
    """Return the ring on its core of sand, sizes in m and s."""
    held = ["casting/base"] if law == "rigid" else ["casting/base", "core/base"]
    air = {"type": "convection", "coefficient": 60.0, "ambient": 20.0}
    return {
        "geometry": {
            "generator": "core_in_ring", "model": "axisymmetric", "core_bore": 0.015,
            "core_radius": 0.03, "outer_radius": 0.045, "height": 0.03, "size": size,
        },
        "bodies": [
            {"name": "casting", "material": "GJL-250", "temperature": 1300.0,
             "law": "thermo-elasto-viscoplastic"},
            {"name": "core", "material": "sand-silica", "temperature": 20.0, "law": law},
        ],
        "interfaces": [{"bodies": ["casting", "core"], "heat": {"from": "iron-sand-coated"}}],
        "boundaries": [
            {"on": "casting/outside", "heat": air},
            *({"on": place, "displacement": {"normal": 0.0}} for place in held),
        ],
        "time": {"end": end},
    }  # fmt: skip


class Answer(NamedTuple):
    """Cost and end of a run.

    Attributes:
        steps: accepted ones.
        cuts: steps that failed.
        iterations: of Newton's method.
        stress: largest equivalent one of the ring at the end [Pa].
    """

    steps: int
    cuts: int
    iterations: int
    stress: float


def run(data: dict[str, Any], comm: MPI.Intracomm) -> Answer:
    """Return cost and end of a run; collective."""
    cuts = iterations = 0
    for state in Simulation.from_case(read_case(data, Path("sand.toml")), comm):
        cuts += state.counters.cutbacks
        iterations += state.counters.mechanics_iterations
        last = state
    stress = last.cellwise("casting", "von_mises")
    most = comm.allreduce(float(np.max(stress, initial=0.0)), op=MPI.MAX)
    return Answer(last.step, cuts, iterations, most)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the ring with each law and print a row of each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("law", nargs="*", default=LAWS, help="of the sand")
    parser.add_argument("--size", type=float, default=3.0, help="of the cells [mm]")
    given = parser.parse_args(arguments)
    strength = find_material("GJL-250", {}).description.tensile_strength
    assert strength is not None
    print(f"strength of GJL-250 at 20 °C: {strength(20.0) / 1e6:.0f} MPa")
    for law in given.law:
        found = run(casting(law, 1e-3 * given.size), MPI.COMM_WORLD)
        print(f"{law}: {found}")


if __name__ == "__main__":
    main()
