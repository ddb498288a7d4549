"""V17: a casting that shrinks away from all sides of a tight closed mould.

A box of w × h, plane strain, cools so that it shrinks freely by s = (1 + ν) α ΔT in the plane. It
stays on the floor by its weight ρ g w h per metre of depth; the gap under the lid is s h, those at
the sides add up to s w. Nothing holds the box sideways: it stays in the middle by the weak springs
on the motions that nothing holds, which carry no force. After M. Chiumenti, Fig. 6.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.process.state import State
from castx.proof.verification.states import pair_places, paired, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

WIDTH, HEIGHT, DENSITY, GRAVITY, SHRINKAGE = 0.1, 0.06, 2400.0, 9.81, 0.012
INTERFACE = "casting/mould"
WEIGHT = DENSITY * GRAVITY * WIDTH * HEIGHT
POISSON, EXPANSION = 0.3, 2e-5
COOLING = SHRINKAGE / ((1 + POISSON) * EXPANSION)
METAL = {
    "young_modulus": 70e9,
    "poisson_ratio": POISSON,
    "expansion": EXPANSION,
    "density": DENSITY,
}


def closed_mould(rigid: bool, seconds: float, **contact: Any) -> dict[str, Any]:
    """Return a casting that cools evenly for some seconds in a rigid or an elastic mould."""
    return {
        "geometry": {
            "generator": "box_in_mould", "model": "plane-strain", "box": [WIDTH, HEIGHT],
            "wall": 0.03, "size": 0.01, "lid": True,
        },
        "materials": {"metal": {**METAL, "stress_free": 500.0}, "steel": {**METAL}},
        "bodies": [
            {"name": "casting", "material": "metal",
             "temperature_history": [[0.0, 500.0], [seconds, 500.0 - COOLING]]},
            {"name": "mould", "material": "steel", "temperature": 20.0,
             "law": "rigid" if rigid else "thermo-elastic"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": contact}],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0.0}}],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "coupling": {"scheme": "mechanical"},
        "time": {"end": seconds},
    }  # fmt: skip


def by_side(state: State, name: str) -> dict[str, FloatArray]:
    """Return the values of the pairs of all ranks by the side of the box that they are on."""
    comm, pairs = state.mesh.comm, state.pairs[INTERFACE]
    values = state.paired(INTERFACE, name)
    sides = {"floor": (1, 1), "lid": (1, -1), "left": (0, 1), "right": (0, -1)}
    return {
        side: np.concatenate(comm.allgather(values[pairs.normals[:, k] * sign > 0.9]))
        for side, (k, sign) in sides.items()
    }


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Cool the casting in an elastic mould and compare."""
    data = closed_mould(False, 2.0, normals="patches")
    data["time"] |= {"fixed_step": 1.0, "first_step": 1.0, "largest_step": 1.0}
    data["geometry"]["size"] = at.size
    for state in states(comm, data):
        totals, gaps, pressures = state.totals, by_side(state, "gap"), by_side(
            state, "contact_pressure"
        )
        points, all_gaps = pair_places(state, INTERFACE), paired(state, INTERFACE, "gap")
    sides = np.concatenate((gaps["left"], gaps["right"]))
    pushed = max(pressures[side].max() for side in ("lid", "left", "right"))
    top = points[:, 1] > HEIGHT - 1e-9
    order = np.argsort(points[top, 0])
    x = points[top, 0][order]
    curve = Curve("under the lid", x, 1e3 * all_gaps[top][order], x[[0, -1]],
                  np.full(2, 1e3 * SHRINKAGE * HEIGHT))  # fmt: skip
    return Outcome(
        (
            Answer.relative("force on the floor", totals[f"{INTERFACE}.force.y"], WEIGHT, "N/m",
                            1e-6),
            Answer.difference("force sideways", totals[f"{INTERFACE}.force.x"], "N/m", 1e-9,
                              WEIGHT),
            Answer.difference("pressure at lid and sides", pushed, "Pa", 1e-9),
            Answer.relative("gap under the lid", gaps["lid"].mean(), SHRINKAGE * HEIGHT, "m", 1e-4),
            Answer.relative("gaps at both sides", gaps["left"].mean() + gaps["right"].mean(),
                            SHRINKAGE * WIDTH, "m", 1e-4),
            Answer.relative("largest gap at a side", sides.max(), 0.5 * SHRINKAGE * WIDTH, "m",
                            1e-3),
            Answer.difference("force of supports", totals["support_force"], "N/m", 1e-4, WEIGHT),
        ),
        abs(totals[f"{INTERFACE}.force.y"] / WEIGHT - 1),
        Comparison("distance from the left wall [m]", "gap [mm]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V17",
    title="A casting that shrinks away from all walls but the floor",
    formula="force on the floor ρ g w h, gap under the lid s h, gaps at both sides s w, "
    "s = (1 + ν) α ΔT",
    source="free shrinkage and weight; after M. Chiumenti, Fig. 6",
    run=compare,
    levels=(Resolution(0.01),),
    quick=(Resolution(0.01),),
    refined="nothing",
)
