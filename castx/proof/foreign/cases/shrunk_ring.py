"""X5: a ring that is heated in another one, which stays cold."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.foreign.rings import draw_rings
from castx.proof.verification.states import drawn_mesh, paired, states

RADII = (0.95, 1.05, 1.15)
YOUNG, POISSON, EXPANSION, RISE = 210e9, 0.3, 12e-6, 727.0


def exact_pressure() -> float:
    """Return p = E α ΔT/[(b² + a²)/(b² − a²) − ν + (c² + b²)/(c² − b²) + ν] [Pa]."""
    a, b, c = RADII
    inside = (b**2 + a**2) / (b**2 - a**2) - POISSON
    outside = (c**2 + b**2) / (c**2 - b**2) + POISSON
    return YOUNG * EXPANSION * RISE / (inside + outside)


def case() -> dict[str, Any]:
    """Return the case: free rings, of which the inner one is heated at once."""
    metal = {
        "young_modulus": YOUNG, "poisson_ratio": POISSON, "expansion": EXPANSION,
        "density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0, "stress_free": 0.0,
    }  # fmt: skip
    rings: list[dict[str, Any]] = [
        {"name": name, "material": "metal", "temperature": 0.0,
         "law": "thermo-elastic", "formulation": "displacement",
         "temperature_history": [[0.0, 0.0], [1.0, rise]]}
        for name, rise in (("inside", RISE), ("outside", 0.0))
    ]  # fmt: skip
    flat = [{"on": f"{ring['name']}/bottom", "displacement": {"normal": 0.0}} for ring in rings]
    free = [
        {"on": f"{ring['name']}/top", "displacement": {"normal": "uniform"}} for ring in rings
    ]
    return {
        "geometry": {"file": "mesh.msh", "model": "axisymmetric"},
        "materials": {"metal": metal},
        "bodies": rings,
        "interfaces": [{"bodies": ["inside", "outside"]}],
        "boundaries": [*flat, *free],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 1.0, "fixed_step": 1.0},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-9},
    }


def run(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return the contact pressure."""
    with drawn_mesh(comm, lambda: draw_rings(("inside", "outside"), RADII, (20, 20), 0.005)) as at:
        for state in states(comm, case(), at):
            pressure = paired(state, "inside/outside", "contact_pressure")
    return (
        Number.relative("contact pressure", None, pressure.mean(), exact_pressure(), "Pa", 1e-4),
    )


CASES = (
    ForeignCase(
        number="X5",
        title="A ring shrunk on by heat",
        program="CalculiX",
        path="test/ring1.inp, ring1.dat.ref",
        exact="Lamé's rings, small strains, 87.04 MPa",
        remark="The program keeps stresses at Gauss points with large strains, 0.7 % above; "
        "−79.0 to −79.3 MPa radially at r = 1.0387 m, no contact pressure.",
        run=run,
    ),
)
