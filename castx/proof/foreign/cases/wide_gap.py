"""X12: a heated core in a vessel, with gas and radiation across a wide gap of cylinders."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.proof.foreign.blocks import draw_blocks
from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.verification.states import drawn_mesh, nodal, places, states

ZERO = 273.15
EDGES = (0.0, 2.0, 2.2, 2.7)
SOURCE = 5e4  # W/m³
CURVED = {"shape": "cylinder", "radii": [2.0, 2.2]}


def case(curved: dict[str, Any] | None) -> dict[str, Any]:
    """Return the case.

    Args:
        curved: entry of the interface; None: the gap counts as plane.
    """
    steel = {"density": 1.0, "heat_capacity": 1.0, "conductivity": 34.6}
    heat = {"law": "limited", "closed": 1e6, "gas_conductivity": 0.1,
            "radiation": {"emissivities": [0.8, 0.8]}}  # fmt: skip
    if curved is not None:
        heat["curved"] = curved
    return {
        "geometry": {"file": "mesh.msh", "model": "axisymmetric"},
        "materials": {"steel": steel},
        "bodies": [
            {"name": "core", "material": "steel", "temperature": 4000.0, "heat_source": SOURCE},
            {"name": "vessel", "material": "steel", "temperature": 4000.0},
        ],
        "interfaces": [{"bodies": ["core", "vessel"], "heat": heat,
                        "contact": {"pairing": "node-to-face", "search_distance": 0.3,
                                    "surfaces": ["core-right", "vessel-left"]}}],
        "boundaries": [{"on": "vessel/vessel-right", "heat": {
            "type": "convection", "coefficient": 10.0, "ambient": 300.0 - ZERO}}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": 1e9, "fixed_step": 1e8, "heat_substeps": 1},
        "solver": {"linear": "direct", "heat_tolerance": 1e-12},
    }  # fmt: skip


def found(comm: MPI.Intracomm, curved: dict[str, Any] | None) -> dict[str, float]:
    """Return the steady temperatures by place [K]."""

    def draw() -> None:
        draw_blocks(("core", "vessel"), EDGES, 0.05, ((100, 1), (25, 1)))

    with drawn_mesh(comm, draw) as folder:
        *_, state = states(comm, case(curved), folder)
        core, vessel = (
            (places(state, body)[:, 0], nodal(state, body, "temperature") + ZERO)
            for body in ("core", "vessel")
        )
    at = {"T(0)": (core, 0.0), "T(2.0 m)": (core, 2.0), "T(2.2 m)": (vessel, 2.2),
          "T(2.7 m)": (vessel, 2.7)}  # fmt: skip
    return {
        name: float(T[np.argmin(np.abs(r - radius))]) for name, ((r, T), radius) in at.items()
    }


EXACT = {"T(0)": 6044.033, "T(2.0 m)": 4598.9466, "T(2.2 m)": 4595.5951, "T(2.7 m)": 4003.7037}
KEPT = {"T(0)": 6044.04, "T(2.0 m)": 4598.9464, "T(2.2 m)": 4595.5949}


def run(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return steady temperatures, and the fall of temperature across the gap."""
    T = found(comm, CURVED)
    fall = T["T(2.0 m)"] - T["T(2.2 m)"]
    return (
        *(Number(name, KEPT.get(name), T[name], exact, "K", 1e-4, 3700.0)
          for name, exact in EXACT.items()),
        Number("fall across the gap", 3.3515, fall, 3.3515, "K", 1e-4, 3.3515),
    )  # fmt: skip


CASES = (
    ForeignCase(
        number="X12",
        title="Gas and radiation across a wide gap of cylinders",
        program="MOOSE",
        path="modules/heat_transfer/test/tests/gap_heat_transfer_mortar/"
        "large_gap_heat_transfer_test_rz_cylinder.i",
        exact="steady conduction k/(r1 ln(r2/r1)) and emissivity 1/(1/ε1 + (r1/r2)(1/ε2 − 1)) of "
        "concentric cylinders",
        remark="Without the curvature of the gap the core is 0.05 K hotter.",
        run=run,
    ),
)
