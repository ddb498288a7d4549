"""V12: stress in a slab that solidifies from a wall and contracts unbent.

J. H. Weiner, B. A. Boley (1963), Elasto-plastic thermal stresses in a solidifying body, J. Mech.
Phys. Solids 11. Temperatures are Neumann's, with ξ = x/X and X = 2λ√(at):

    θ(ξ) = T_w + (T_m − T_w) erf(λξ)/erf(λ),   Y(θ) = Y_w (T_m − θ)/(T_m − T_w).

The lateral strain is C ln X + constant, so that where the solid is elastic

    dσ/dξ = −E/(1 − ν) (C/ξ + α θ'(ξ)).

New solid yields in tension, σ = Y, down to x1, where the elastic stress leaves the yield stress
along its tangent; below x2 it yields in compression, σ = −Y. C, x1 and x2 follow from that, from
σ(x2) = −Y and from ∫σ dξ = 0.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.optimize import fsolve
from scipy.special import erf

from castx.arrays import FloatArray
from castx.process.state import State
from castx.proof.verification.heat.neumann import Neumann
from castx.proof.verification.states import (
    cell_volumes,
    cellwise,
    centres,
    nodal,
    places,
    states,
)
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)


class Slab(NamedTuple):
    """Data of a slab in SI units, °C."""

    density: float
    heat_capacity: float
    conductivity: float
    latent_heat: float
    melting: float
    wall: float
    initial: float
    expansion: float
    young: float
    poisson: float
    yield_at_wall: float

    def front(self, time: float) -> float:
        """Return X [m]."""
        return self.metal.front(time)

    @property
    def metal(self) -> Neumann:
        """The half-space whose front it is, with equal properties of solid and liquid."""
        capacity = self.density * self.heat_capacity
        return Neumann(
            (self.conductivity, self.conductivity), (capacity, capacity),
            self.density * self.latent_heat, self.melting, self.wall, self.initial,
        )  # fmt: skip

    @property
    def front_number(self) -> float:
        """Neumann's λ."""
        return self.metal.front_number


STEEL = Slab(7200.0, 680.0, 34.0, 272e3, 1490.0, 1362.0, 1550.0, 8.46354e-5, 40e9, 0.35, 40e6)
OTHER = Slab(2600.0, 1100.0, 95.0, 390e3, 650.0, 500.0, 680.0, 2.6e-5, 45e9, 0.33, 25e6)


class Solution(NamedTuple):
    """C, x1 and x2, with the slab."""

    slab: Slab
    rate: float
    tension: float
    compression: float

    def temperature(self, xi: Any) -> Any:
        """Return θ(ξ) [°C]."""
        s, n = self.slab, self.slab.front_number
        return s.wall + (s.melting - s.wall) * erf(n * xi) / erf(n)

    def yield_stress(self, xi: Any) -> Any:
        """Return Y(θ(ξ)) [Pa]."""
        s = self.slab
        return s.yield_at_wall * (s.melting - self.temperature(xi)) / (s.melting - s.wall)

    def elastic(self, xi: Any) -> Any:
        """Return the stress where the slab is elastic [Pa]."""
        s = self.slab
        cooled = self.temperature(xi) - self.temperature(self.tension)
        strain = self.rate * np.log(xi / self.tension) + s.expansion * cooled
        return self.yield_stress(self.tension) - s.young / (1 - s.poisson) * strain

    def stress(self, xi: Any) -> FloatArray:
        """Return σ(ξ), zero in the liquid [Pa]."""
        xi = np.asarray(xi)
        inside = self.elastic(np.clip(xi, self.compression, self.tension))
        limit = self.yield_stress(xi)
        found = np.where(xi < self.compression, -limit, np.where(xi > self.tension, limit, inside))
        return np.where(xi >= 1.0, 0.0, found)

    def resultant(self) -> float:
        """Return ∫σ dξ over the solid [Pa]."""
        nodes, weights = leggauss(40)
        ends = (0.0, self.compression, self.tension, 1.0)
        return float(
            sum(
                0.5 * (b - a) * weights @ self.stress(0.5 * (a + b) + 0.5 * (b - a) * nodes)
                for a, b in pairwise(ends)
            )
        )


def solve(slab: Slab) -> Solution:
    """Return the stress by its three conditions, tangent first."""
    n, span = slab.front_number, slab.melting - slab.wall

    def tangent_rate(x1: float) -> float:
        slope = span * 2 * n * np.exp(-((n * x1) ** 2)) / (np.sqrt(np.pi) * erf(n))
        softening = slab.yield_at_wall / span
        return float(x1 * slope * (softening * (1 - slab.poisson) / slab.young - slab.expansion))

    def conditions(unknown: Any) -> list[float]:
        x1, x2 = unknown
        made = Solution(slab, tangent_rate(x1), x1, x2)
        scale = slab.yield_at_wall
        return [
            float(made.elastic(x2) + made.yield_stress(x2)) / scale,
            made.resultant() / scale,
        ]

    x1, x2 = fsolve(conditions, (0.45, 0.2), xtol=1e-13)
    return Solution(slab, tangent_rate(x1), x1, x2)


def slab_case(
    slab: Slab, model: str, cells: str, *, resolution: int, end: float, **body: Any
) -> dict[str, Any]:
    """Return the case with `resolution` elements on the solid at the end."""
    size = slab.front(end) / resolution
    lateral = {"bottom": "top"}
    geometry: dict[str, Any] = {
        "generator": "slab", "model": model, "cells": cells,
        "length": 3.5 * slab.front(end), "width": 2 * size, "size": size,
    }  # fmt: skip
    if model == "3d":
        geometry["depth"] = geometry["width"] = size
        lateral["back"] = "front"
    boundaries: list[dict[str, Any]] = [
        {"on": "casting/wall", "heat": {"type": "temperature", "value": slab.wall},
         "displacement": {"normal": 0.0}},
    ]  # fmt: skip
    for held, free in lateral.items():
        boundaries.append({"on": f"casting/{held}", "displacement": {"normal": 0.0}})
        boundaries.append({"on": f"casting/{free}", "displacement": {"normal": "uniform"}})
    material = {
        "density": slab.density, "heat_capacity": slab.heat_capacity,
        "conductivity": slab.conductivity, "latent_heat": slab.latent_heat,
        "solidus": slab.melting, "liquidus": slab.melting,
        "young_modulus": slab.young, "poisson_ratio": slab.poisson, "expansion": slab.expansion,
        "yield_stress": [
            [slab.wall, slab.yield_at_wall], [slab.melting, 1e-5 * slab.yield_at_wall]
        ],
        "dissipation": 0.0, "liquid": {"viscosity": 1e5, "coherency": 0.5},
    }  # fmt: skip
    return {
        "geometry": geometry,
        "materials": {"metal": material},
        "bodies": [{"name": "casting", "material": "metal", "temperature": slab.initial,
                    "law": "thermo-elasto-plastic", **body}],
        "boundaries": boundaries,
        "time": {"end": end},
    }  # fmt: skip


class Found(NamedTuple):
    """Results of a run: ξ and lateral stresses of the cells, lateral strain over time."""

    xi: FloatArray
    stress: FloatArray
    along: FloatArray
    volumes: FloatArray
    strain: dict[float, float]
    cutbacks: int


def follow(run: Iterable[State], data: dict[str, Any], slab: Slab) -> Found:
    """Return stress, strain and cutbacks found in the states of a run."""
    strain, cutbacks, width = {}, 0, data["geometry"]["width"]
    for state in run:
        cutbacks += state.counters.cutbacks
        top = np.isclose(places(state, "casting")[:, 1], width)
        moved = nodal(state, "casting", "displacement")[top, 1]
        strain[round(state.time, 6)] = float(moved.mean()) / width
    xi = np.asarray(centres(state, "casting")[:, 0] / slab.front(state.time), dtype=np.float64)
    stress = cellwise(state, "casting", "stress")
    volumes = cell_volumes(state, "casting")
    return Found(xi, stress[:, 1:3], stress[:, 0], volumes, strain, cutbacks)


FORMULATIONS = {
    "triangles": ("generalised-plane-strain", "simplices"),
    "quadrilaterals": ("generalised-plane-strain", "quadrilaterals"),
    "tetrahedra": ("3d", "simplices"),
    "hexahedra": ("3d", "quadrilaterals"),
}


class Means(NamedTuple):
    """ξ, lateral stresses and stress along the slab of the layers."""

    xi: FloatArray
    stress: FloatArray
    along: FloatArray


def bin_means(found: Found, resolution: int) -> Means:
    """Return means over the layers of elements: linear triangles zigzag within one."""
    layer = np.floor(found.xi * resolution + 1e-9).astype(int)
    weight = np.bincount(layer, found.volumes)

    def mean(values: FloatArray) -> FloatArray:
        return np.bincount(layer, found.volumes * values) / weight

    stress = np.stack([mean(column) for column in found.stress.T], axis=1)
    return Means(mean(found.xi), stress, mean(found.along))


END, EARLY = 10.0, 1.0


def stepped(case: dict[str, Any], step: float) -> dict[str, Any]:
    """Return a case in equal steps, solved directly and to a tight tolerance."""
    numerics = {"linear": "direct", "mechanics_tolerance": 1e-5}
    return {**case, "time": {**case["time"], "fixed_step": step}, "solver": numerics}


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run to 10 s and compare; the size of the elements is a share of the solid at the end."""
    slab, exact = STEEL, solve(STEEL)
    resolution = round(slab.front(END) / at.size)
    data = slab_case(slab, *FORMULATIONS["triangles"], resolution=resolution, end=END)
    found = follow(states(comm, stepped(data, at.step)), data, slab)
    means, scale = bin_means(found, resolution), slab.yield_at_wall
    error = means.stress[:, 0] - exact.stress(means.xi)
    away = np.abs(means.xi - 1.0) > 2.0 / resolution
    early = min((time for time in found.strain if time >= EARLY), key=lambda t: t - EARLY)
    growth = exact.rate * 0.5 * np.log(END / early)
    solid = found.xi < 1.0
    force = found.volumes @ found.stress[:, 0] / found.volumes[solid].sum()
    shown, line = means.xi < 1.3, fine(1e-3, 1.3)
    curve = Curve("10 s", means.xi[shown], 1e-6 * means.stress[shown, 0], line,
                  1e-6 * exact.stress(line))  # fmt: skip
    return Outcome(
        (
            Answer.difference("stress, 2 elements off the front", np.abs(error[away]).max(), "Pa",
                              0.05, scale),
            Answer.relative(f"lateral strain from {early:g} s on",
                            found.strain[END] - found.strain[early], growth, "", 0.03),
            Answer.difference("net lateral force over that of the solid at yield", force, "Pa",
                              1e-3, scale),
        ),
        float(np.sqrt(np.mean(error[means.xi < 1.0] ** 2))) / scale,
        Comparison("distance from the wall over the thickness of the solid", "lateral stress [MPa]",
                   (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V12",
    title="Stress in a solidifying slab",
    formula="dσ/dξ = −E/(1 − ν) (C/ξ + α θ'(ξ)) between tension and compression at yield, "
    "σ(x1) = Y and tangent to it, σ(x2) = −Y, ∫σ dξ = 0, θ after Neumann",
    source="J. H. Weiner, B. A. Boley (1963), J. Mech. Phys. Solids 11",
    run=compare,
    levels=tuple(
        Resolution(STEEL.front(END) / n, step) for n, step in ((15, 0.4), (30, 0.2), (60, 0.1))
    ),
    quick=tuple(Resolution(STEEL.front(END) / n, step) for n, step in ((30, 0.25), (60, 0.2))),
    norm="root mean square of the stress error of the solid, over the yield stress at the wall",
)
