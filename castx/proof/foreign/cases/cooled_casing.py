"""X4: casing, cement and rock; the cement shrinks away from the rock as the casing is cooled."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.process.state import State
from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.foreign.rings import draw_rings
from castx.proof.verification.states import drawn_mesh, nodal, paired, places, states

RADII = (0.15707, 0.17780, 0.21272, 1.5707)
MATERIALS = {
    "casing": (220e9, 0.27, 1.2e-5, 15.0, 1.375e6),
    "cement": (4e9, 0.21, 2e-5, 1.0, 4.2e6),
    "rock": (9.3e9, 0.22, 2e-5, 1.66, 4.56e6),
}
"""E [Pa], ν, α [1/K], k [W/m/K], ρ c [J/m³/K]."""
HEIGHT = 0.005


def case(end: float, steps: int) -> dict[str, Any]:
    """Return the case of a drawn strip of rings."""
    materials = {
        name: {"young_modulus": E, "poisson_ratio": nu, "expansion": alpha, "conductivity": k,
               "density": 1000.0, "heat_capacity": 1e-3 * capacity, "stress_free": 100.0}
        for name, (E, nu, alpha, k, capacity) in MATERIALS.items()
    }  # fmt: skip
    flat = [
        {"on": f"{name}/{side}", "displacement": {"normal": 0.0}}
        for name in MATERIALS
        for side in ("bottom", "top")
    ]
    perfect = {"heat": {"law": "perfect"}}
    return {
        "geometry": {"file": "mesh.msh", "model": "axisymmetric"},
        "materials": materials,
        "bodies": [{"name": n, "material": n, "temperature": 100.0,
                    "law": "thermo-elastic", "formulation": "displacement"} for n in MATERIALS],
        "interfaces": [{"bodies": ["cement", "casing"], **perfect},
                       {"bodies": ["cement", "rock"], **perfect}],
        "boundaries": [
            {"on": "casing/inner", "heat": {"type": "temperature", "value": -20.0}},
            {"on": "rock/outer", "displacement": {"normal": 0.0},
             "heat": {"type": "temperature", "value": 100.0}},
            *flat,
        ],
        "time": {"end": end, "fixed_step": end / steps, "first_step": end / steps,
                 "largest_step": end / steps, "heat_substeps": 1},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-8},
    }  # fmt: skip


def at(state: State, body: str, name: str, radius: float) -> float:
    """Return a nodal value at a radius, of the displacement the radial one."""
    values, points = nodal(state, body, name), places(state, body)
    order = np.argsort(points[:, 0])
    column = values[:, 0] if values.ndim == 2 else values
    return float(np.interp(radius, points[order, 0], column[order]))


def last(comm: MPI.Intracomm, end: float, steps: int) -> dict[str, float]:
    """Return temperatures, displacements and the gap at the end of a run."""
    _, outside, wall, _ = RADII

    def draw() -> None:
        draw_rings(tuple(MATERIALS), RADII, (16, 24, 240), HEIGHT)

    with drawn_mesh(comm, draw) as folder:
        for state in states(comm, case(end, steps), folder):
            if state.step < steps:
                continue
            return {
                "T(0.1778 m)": at(state, "casing", "temperature", outside),
                "T(0.21272 m)": at(state, "cement", "temperature", wall),
                "u(0.15707 m)": at(state, "casing", "displacement", RADII[0]),
                "gap of cement and rock": float(paired(state, "cement/rock", "gap").mean()),
            }
    raise AssertionError


KEPT = {
    1e4: {"T(0.1778 m)": -17.1038, "T(0.21272 m)": 43.8026, "u(0.15707 m)": -2.845549e-4,
          "gap of cement and rock": 4.00817e-4},
    1e5: {"T(0.1778 m)": -18.5817, "T(0.21272 m)": 12.1062, "u(0.15707 m)": -2.881041e-4,
          "gap of cement and rock": 4.54837e-4},
}  # fmt: skip
EXACT = {
    1e4: {"T(0.1778 m)": -17.0978, "T(0.21272 m)": 43.9159, "u(0.15707 m)": -2.84610e-4,
          "gap of cement and rock": 4.00820e-4},
    1e5: {"T(0.1778 m)": -18.5814, "T(0.21272 m)": 12.1125, "u(0.15707 m)": -2.88231e-4,
          "gap of cement and rock": 4.54782e-4},
}  # fmt: skip


def run(comm: MPI.Intracomm, steps: int = 100) -> tuple[Number, ...]:
    """Return the answers after 10,000 and 100,000 seconds."""
    numbers = []
    for end in KEPT:
        found = last(comm, end, steps)
        for name, exact in EXACT[end].items():
            thermal = name.startswith("T")
            numbers.append(
                Number(f"{name}, {end:g} s", KEPT[end][name], found[name], exact,
                       "°C" if thermal else "m", 1e-3, 120.0 if thermal else abs(exact))
            )  # fmt: skip
    return tuple(numbers)


CASES = (
    ForeignCase(
        number="X4",
        title="A shrinking ring leaves its mould",
        program="GEOS",
        path="inputFiles/wellbore/CasedThermoElasticWellbore_ImperfectInterfaces_benchmark.xml "
        "and its analytic tables",
        exact="one-dimensional finite elements, 600 cells",
        remark="The table of the program is good to 0.1 K and 1e-4 of the displacements; castx "
        "has first-order steps, 100 for each time.",
        run=run,
    ),
)
