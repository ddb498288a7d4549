"""V12, its exact answer: stress in a slab that solidifies from a wall and contracts unbent.

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
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq, fsolve
from scipy.special import erf, erfc

from castx.process.state import State
from tests import coupled_cases


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

    @property
    def diffusivity(self) -> float:
        return self.conductivity / (self.density * self.heat_capacity)

    def front(self, time: float) -> float:
        return 2 * self.front_number * np.sqrt(self.diffusivity * time)

    @property
    def front_number(self) -> float:
        """Neumann's λ for equal properties of solid and liquid."""
        below, above = self.melting - self.wall, self.initial - self.melting
        stefan = np.sqrt(np.pi) * self.latent_heat / self.heat_capacity

        def balance(n: float) -> float:
            heat = below / erf(n) - above / erfc(n)
            return float(heat * np.exp(-n * n) - stefan * n)

        return float(brentq(balance, 1e-3, 3.0, xtol=1e-14))


STEEL = Slab(7200.0, 680.0, 34.0, 272e3, 1490.0, 1362.0, 1550.0, 8.46354e-5, 40e9, 0.35, 40e6)
OTHER = Slab(2600.0, 1100.0, 95.0, 390e3, 650.0, 500.0, 680.0, 2.6e-5, 45e9, 0.33, 25e6)


class Solution(NamedTuple):
    """C, x1 and x2, with the slab."""

    slab: Slab
    rate: float
    tension: float
    compression: float

    def temperature(self, xi):
        s, n = self.slab, self.slab.front_number
        return s.wall + (s.melting - s.wall) * erf(n * xi) / erf(n)

    def yield_stress(self, xi):
        s = self.slab
        return s.yield_at_wall * (s.melting - self.temperature(xi)) / (s.melting - s.wall)

    def elastic(self, xi):
        s = self.slab
        cooled = self.temperature(xi) - self.temperature(self.tension)
        strain = self.rate * np.log(xi / self.tension) + s.expansion * cooled
        return self.yield_stress(self.tension) - s.young / (1 - s.poisson) * strain

    def stress(self, xi):
        xi = np.asarray(xi)
        inside = self.elastic(np.clip(xi, self.compression, self.tension))
        limit = self.yield_stress(xi)
        found = np.where(xi < self.compression, -limit, np.where(xi > self.tension, limit, inside))
        return np.where(xi >= 1.0, 0.0, found)

    def resultant(self) -> float:
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
    """What a run gives: ξ and lateral stresses of the cells, lateral strain over time."""

    xi: np.ndarray
    stress: np.ndarray
    along: np.ndarray
    volumes: np.ndarray
    strain: dict[float, float]
    cutbacks: int


def run(comm: MPI.Intracomm, data: dict[str, Any], slab: Slab) -> Found:
    """Run a case and return what it gives."""
    return follow(coupled_cases.simulation(comm, data), data, slab)


def follow(states: Iterable[State], data: dict[str, Any], slab: Slab) -> Found:
    """Return what the states of a run give."""
    strain, cutbacks = {}, 0
    for state in states:
        comm = state.mesh.comm
        cutbacks += state.counters.cutbacks
        points = coupled_cases.places(state, "casting")
        top = np.isclose(points[:, 1], data["geometry"]["width"])
        moved = state.nodal("casting", "displacement")[: len(points)]
        local = (moved[top, 1].sum(), np.count_nonzero(top))
        total, count = np.sum(comm.allgather(local), axis=0)
        strain[round(state.time, 6)] = total / count / data["geometry"]["width"]
    mesh = state.mesh.bodies["casting"]
    owned = mesh.mesh.topology.index_map(mesh.mesh.topology.dim).size_local
    assert state.problem.mechanics is not None
    mechanics = state.problem.mechanics.bodies["casting"]
    found = (
        mesh.points[mesh.nodes.dofmap.list[:owned]].mean(axis=1)[:, 0] / slab.front(state.time),
        state.cellwise("casting", "stress")[:owned],
        mechanics.points.weights.sum(axis=1)[:owned],
    )
    xi, stress, volumes = (np.concatenate(comm.allgather(part)) for part in found)
    return Found(xi, stress[:, 1:3], stress[:, 0], volumes, strain, cutbacks)


FORMULATIONS = {
    "triangles": ("generalised-plane-strain", "simplices"),
    "quadrilaterals": ("generalised-plane-strain", "quadrilaterals"),
    "tetrahedra": ("3d", "simplices"),
    "hexahedra": ("3d", "quadrilaterals"),
}


def check(found: Found, exact: Solution, resolution: int, times: tuple[float, float]) -> None:
    scale = exact.slab.yield_at_wall
    means = bin_means(found, resolution)
    away = np.abs(means.xi - 1.0) > 2.0 / resolution
    for lateral in means.stress.T:
        assert np.abs(lateral - exact.stress(means.xi))[away].max() < 0.05 * scale
    assert np.abs(means.along[away]).max() < 0.01 * scale
    change = found.strain[times[1]] - found.strain[times[0]]
    expected = exact.rate * 0.5 * np.log(times[1] / times[0])
    assert change == pytest.approx(expected, rel=0.03)
    # The force on the lateral face, per Y_w X of the solid.
    force = found.volumes @ found.stress[:, 0] / found.volumes[found.xi < 1.0].sum()
    assert abs(force) < 1e-3 * scale
    assert found.cutbacks == 0
    sign = means.xi[means.stress[:, 0] > 0].min()
    assert sign == pytest.approx(brentq(exact.elastic, exact.compression, exact.tension), abs=0.02)


class Means(NamedTuple):
    xi: np.ndarray
    stress: np.ndarray
    along: np.ndarray


def bin_means(found: Found, resolution: int) -> Means:
    """Return means over the layers of elements: linear triangles zigzag within one."""
    layer = np.floor(found.xi * resolution + 1e-9).astype(int)
    weight = np.bincount(layer, found.volumes)

    def mean(values):
        return np.bincount(layer, found.volumes * values) / weight

    stress = np.stack([mean(column) for column in found.stress.T], axis=1)
    return Means(mean(found.xi), stress, mean(found.along))
