"""X9: metal freezes in a spherical shell that radiates."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.verification.states import drawn_mesh, nodal, places, states

ZERO, SCALE = 273.15, 100.0
"""A temperature of 1 of the program is 100 K."""
RADII = (1.0 / 3.0, 0.9, 1.0)
ANGLE = 0.02
"""Of the wedge above the equator, whose sides no heat crosses."""
SOLIDUS, LIQUIDUS = 785.0, 805.0
EXACT = {
    1.5: (8.8328, 8.6837, 8.3702, 8.1155, 8.0030, 7.8695, 7.6519),
    2.0: (8.3781, 8.2740, 8.0714, 7.8762, 7.7537, 7.6308, 7.4358),
    2.5: (8.0972, 8.0462, 7.8531, 7.6016, 7.4957, 7.3887, 7.2171),
}
KEPT = {
    1.5: (8.8326, 8.6831, 8.3694, 8.1144, 8.0025, 7.8678, 7.6505),
    2.0: (8.3777, 8.2731, 8.0702, 7.8758, 7.7532, 7.6302, 7.4351),
    2.5: (8.0964, 8.0450, 7.8531, 7.6015, 7.4955, 7.3884, 7.2167),
}
PLACES = (0.3531, 0.5308, 0.7123, 0.8305, 0.8800, 0.9099, 0.9899)


def draw() -> None:
    """Draw a wedge of metal and shell, a cell high."""
    geo = gmsh.model.geo
    centre = geo.addPoint(0, 0, 0)
    low, high = (
        [geo.addPoint(r * np.cos(a), r * np.sin(a), 0) for r in RADII] for a in (0.0, ANGLE)
    )
    arcs = [geo.addCircleArc(a, centre, b) for a, b in zip(low, high, strict=True)]
    for arc in arcs:
        geo.mesh.setTransfiniteCurve(arc, 2)
    for number, (name, count) in enumerate((("casting", 96), ("mould", 24))):
        below = geo.addLine(low[number], low[number + 1])
        above = geo.addLine(high[number], high[number + 1])
        loop = geo.addCurveLoop([below, arcs[number + 1], -above, -arcs[number]])
        part = geo.addPlaneSurface([loop])
        for line in (below, above):
            geo.mesh.setTransfiniteCurve(line, count + 1)
        geo.mesh.setTransfiniteSurface(part)
        geo.mesh.setRecombine(2, part)
        geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [part], name=name)
    gmsh.model.addPhysicalGroup(1, arcs[-1:], name="outside")
    gmsh.model.mesh.generate(2)


def case(step: float) -> dict[str, Any]:
    """Return the case in °C with equal steps [s]; the liquid fraction is s² (3 − 2 s)."""
    plain = {"density": 1.0, "heat_capacity": 567.0374, "conductivity": 56.70374}
    shares = np.linspace(0.0, 1.0, 41)
    fraction = [
        [SOLIDUS - ZERO + (LIQUIDUS - SOLIDUS) * s, 1.0 - s * s * (3.0 - 2.0 * s)] for s in shares
    ]
    metal = plain | {
        "latent_heat": 28351.87, "solidus": SOLIDUS - ZERO, "liquidus": LIQUIDUS - ZERO,
        "solid_fraction": fraction,
    }  # fmt: skip
    return {
        "geometry": {"file": "mesh.msh", "model": "axisymmetric"},
        "materials": {"metal": metal, "shell": plain},
        "bodies": [{"name": n, "material": m, "temperature": 1000.0 - ZERO}
                   for n, m in (("casting", "metal"), ("mould", "shell"))],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "constant", "closed": 2835.187}}],
        "boundaries": [{"on": "mould/outside", "heat": {"type": "radiation", "emissivity": 0.8,
                                                        "ambient": 100.0 - ZERO}}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": 2.5, "fixed_step": step, "heat_substeps": 1},
        "solver": {"linear": "direct"},
    }  # fmt: skip


def run(comm: MPI.Intracomm, step: float = 0.005) -> tuple[Number, ...]:
    """Return temperatures over 100 K at seven radii and three times."""
    numbers = []
    with drawn_mesh(comm, draw) as folder:
        for state in states(comm, case(step), folder):
            time = round(state.time, 6)
            if time not in EXACT:
                continue
            at, found = [], []
            for name in ("casting", "mould"):
                at.append(np.linalg.norm(places(state, name), axis=1))
                found.append((nodal(state, name, "temperature") + ZERO) / SCALE)
            for number, radius in enumerate(PLACES):
                body = int(radius > RADII[1])
                order = np.argsort(at[body])
                value = np.interp(radius, at[body][order], found[body][order])
                row, kept = f"θ(r = {radius:g}), t = {time:g}", KEPT[time][number]
                exact = EXACT[time][number]
                numbers.append(Number(row, kept, float(value), exact, "", 3e-3, 1.0))
    return tuple(numbers)


CASES = (
    ForeignCase(
        number="X9",
        title="Metal freezes in a spherical shell that radiates",
        program="Truchas",
        path="test/ds11",
        exact="one-dimensional finite volumes, 668 cells, steps of 2.5e-4",
        remark="The only casting among these cases. Numbers of the program are means over the "
        "cells of a shell; a linear solid fraction instead of the smooth one would move the first "
        "row at t = 2.5 by 0.005.",
        run=run,
    ),
)
