"""V20 without ends: a slice of a cylinder in its mould, beside a radial solution of its own.

Between planes that do not move, the coupled cylinder depends on the radius only: enthalpy with an
isothermal front, plane-strain thermo-elasticity of a solid and a hollow cylinder, and an air gap
that throttles the heat, h = min(h0, k/g). The reference solves these equations on its own fine
radial grid with small steps: linear elements in r, lumped enthalpy, Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.linalg import solve_banded

from castx.arrays import FloatArray
from castx.process.state import State
from castx.proof.verification.states import nodal, pair_areas, paired, places, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

RADIUS, WALL, HEIGHT = 0.025, 0.02, 0.0025
MELT, POUR, START = 640.0, 655.0, 180.0
DENSITY, CAPACITY, LATENT, CONDUCTIVITY = 2600.0, 1100.0, 380e3, (180.0, 90.0)
YOUNG, POISSON, EXPANSION = (68e9, 8e9), 0.34, 2.5e-5
MOULD = {"density": 7700.0, "heat_capacity": 500.0, "conductivity": 30.0, "young_modulus": 200e9,
         "poisson_ratio": 0.28, "expansion": 1.1e-5}  # fmt: skip
CLOSED, GAS = 2600.0, 0.06
END = 16.0
ROUNDS = 40
"""Newton iterations of a step at most."""

Coefficient = Callable[[float, float], float]
"""Heat-transfer coefficient over gap and solid fraction at the start of a step."""


@dataclass
class Cylinder1D:
    """Linear elements in the radius of a solid or hollow cylinder, per radian and unit height."""

    r: FloatArray

    def __post_init__(self) -> None:
        self.length: FloatArray = np.diff(self.r)
        self.middle: FloatArray = (self.r[1:] + self.r[:-1]) / 2
        share = self.length * self.middle / 2
        self.volume = np.concatenate((share, [0.0])) + np.concatenate(([0.0], share))

    def conduction(self, k: FloatArray) -> FloatArray:
        """Return the tridiagonal matrix of ∫ k T' v' r dr, as bands."""
        g = k * self.middle / self.length
        bands = np.zeros((3, len(self.r)))
        bands[0, 1:], bands[2, :-1] = -g, -g
        bands[1, :-1] += g
        bands[1, 1:] += g
        return bands

    def displacement(self, young: FloatArray, poisson: float, strain: FloatArray) -> FloatArray:
        """Return u(r) for ε_z = 0, free surfaces and linear thermal strains of the elements."""
        lam = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        mu = young / (2 * (1 + poisson))
        weight = self.length * self.middle
        # Rows of ε_r and ε_θ for the two nodes of an element, strains at its middle.
        radial = np.stack((-1 / self.length, 1 / self.length))
        hoop = np.full_like(radial, 0.5) / self.middle
        bands, load = np.zeros((3, len(self.r))), np.zeros(len(self.r))
        first = np.arange(len(self.length))
        for i in range(2):
            pressure = (3 * lam + 2 * mu) * strain * weight
            np.add.at(load, first + i, pressure * (radial[i] + hoop[i]))
            for j in range(2):
                trace = (radial[i] + hoop[i]) * (radial[j] + hoop[j])
                shear = radial[i] * radial[j] + hoop[i] * hoop[j]
                np.add.at(bands[1 + i - j], first + j, weight * (lam * trace + 2 * mu * shear))
        if self.r[0] == 0.0:
            bands[1, 0], bands[0, 1], load[0] = 1.0, 0.0, 0.0
        return np.asarray(solve_banded((1, 1), bands, load))


def temperature_of(H: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return T, dT/dH and f_s of the metal; H = 0 is the solid at the melting point."""
    c, latent = DENSITY * CAPACITY, DENSITY * LATENT
    over = np.maximum(H - latent, 0.0)
    T = MELT + (np.minimum(H, 0.0) + over) / c
    slope = np.where((H < 0) | (H > latent), 1 / c, 0.0)
    return T, slope, np.clip(1 - H / latent, 0.0, 1.0)


class Slice1D:
    """Casting and mould on a radial grid.

    Args:
        cells: of each.
    """

    def __init__(self, cells: int) -> None:
        even: FloatArray = np.linspace(0.0, 1.0, cells + 1, dtype=np.float64)
        self.metal = Cylinder1D(RADIUS * even)
        self.die = Cylinder1D(RADIUS + WALL * even**1.5)
        self.nodes = cells + 1
        self.capacity = MOULD["density"] * MOULD["heat_capacity"]
        self.volume = np.concatenate((self.metal.volume, self.die.volume))
        self.die_bands = self.die.conduction(np.full(cells, MOULD["conductivity"]))

    def start(self) -> FloatArray:
        """Return the enthalpy at the start [J/m³]."""
        poured = DENSITY * (LATENT + CAPACITY * (POUR - MELT))
        cold = START * self.capacity
        return np.concatenate((np.full(self.nodes, poured), np.full(self.nodes, cold)))

    def temperatures(self, H: FloatArray) -> FloatArray:
        """Return the temperatures of casting and mould [°C]."""
        return np.concatenate((temperature_of(H[: self.nodes])[0], H[self.nodes :] / self.capacity))

    def solid(self, H: FloatArray) -> float:
        """Return the solid fraction of the casting."""
        fraction = temperature_of(H[: self.nodes])[2]
        return float(self.metal.volume @ fraction / self.metal.volume.sum())

    def advanced(self, old: FloatArray, step: float, h: float) -> FloatArray:
        """Return the enthalpy after an implicit step with a heat-transfer coefficient."""
        n, H, exchange = self.nodes, old.copy(), h * RADIUS
        for _ in range(ROUNDS):
            _, slope, fraction = temperature_of(H[:n])
            k = CONDUCTIVITY[0] * fraction + CONDUCTIVITY[1] * (1 - fraction)
            bands = np.hstack((self.metal.conduction((k[1:] + k[:-1]) / 2), self.die_bands))
            bands[1, n - 1] += exchange
            bands[1, n] += exchange
            bands[0, n], bands[2, n - 1] = -exchange, -exchange
            T = self.temperatures(H)
            flow = bands[1] * T
            flow[:-1] += bands[0, 1:] * T[1:]
            flow[1:] += bands[2, :-1] * T[:-1]
            balance = self.volume * (H - old) / step + flow
            if np.abs(balance).sum() < 1e-9 * np.abs(flow).sum():
                break
            matrix = bands * np.concatenate((slope, np.full(n, 1 / self.capacity)))
            matrix[1] += self.volume / step
            H = H - solve_banded((1, 1), matrix, balance)
        return H

    def gap(self, H: FloatArray) -> float:
        """Return the gap between the free cylinders [m]."""
        T, T_die = np.split(self.temperatures(H), 2)
        middle, middle_die = (T[1:] + T[:-1]) / 2, (T_die[1:] + T_die[:-1]) / 2
        young = np.interp(middle, (20.0, MELT), YOUNG)
        shrunk = EXPANSION * (np.minimum(T[1:], MELT) + np.minimum(T[:-1], MELT) - 2 * MELT) / 2
        u = self.metal.displacement(young, POISSON, shrunk)
        stiff = np.full_like(middle_die, MOULD["young_modulus"])
        grown = MOULD["expansion"] * (middle_die - START)
        v = self.die.displacement(stiff, MOULD["poisson_ratio"], grown)
        return float(v[0] - u[-1])


def limited(gap: float, solid: float) -> float:
    """Return h = min(h0, k/g)."""
    return min(CLOSED, GAS / gap) if gap > 0 else CLOSED


def reference(
    cells: int,
    step: float,
    times: FloatArray,
    end: float = END,
    coefficient: Coefficient = limited,
) -> dict[str, FloatArray]:
    """Return histories: temperatures of centre and of both surfaces, gap and solid fraction.

    Args:
        cells: of casting and of mould.
        step: [s].
        times: of the histories [s].
        end: of the solution [s].
        coefficient: from gap and solid fraction at the start of a step.
    """
    grid, rows, gap = Slice1D(cells), [], 0.0
    H = grid.start()
    for _ in range(round(end / step)):
        H = grid.advanced(H, step, coefficient(gap, grid.solid(H)))
        gap, T = grid.gap(H), grid.temperatures(H)
        rows.append((T[0], T[grid.nodes - 1], T[grid.nodes], gap, grid.solid(H)))
    time = step * np.arange(1, len(rows) + 1)
    names = ("centre", "surface", "mould", "gap", "solid")
    histories = zip(names, np.transpose(rows), strict=True)
    return {name: np.interp(times, time, history) for name, history in histories}


def slice_case(size: float = RADIUS / 40, step: float = 0.1) -> dict[str, Any]:
    """Return the slice as a case."""
    metal = {
        "density": DENSITY, "heat_capacity": CAPACITY, "latent_heat": LATENT,
        "conductivity": {"solid": CONDUCTIVITY[0], "liquid": CONDUCTIVITY[1]},
        "solidus": MELT, "liquidus": MELT, "expansion": EXPANSION, "poisson_ratio": POISSON,
        "young_modulus": [[20.0, YOUNG[0]], [MELT, YOUNG[1]]],
    }  # fmt: skip
    return {
        "geometry": {"generator": "cylinder_in_mould", "model": "axisymmetric", "radius": RADIUS,
                     "height": HEIGHT, "wall": WALL, "size": size},
        "materials": {"aluminium": metal, "steel": MOULD},
        "bodies": [
            {"name": "casting", "material": "aluminium", "temperature": POUR},
            {"name": "mould", "material": "steel", "temperature": START,
             "formulation": "displacement"},
        ],
        "interfaces": [
            {"bodies": ["casting", "mould"], "contact": {"method": "condensed"},
             "heat": {"law": "limited", "closed": CLOSED, "gas_conductivity": GAS}},
        ],
        "boundaries": [
            {"on": f"{body}/{end}", "displacement": {"normal": 0.0}}
            for body in ("casting", "mould")
            for end in ("base", "top")
        ],
        "time": {"end": END, "fixed_step": step},
    }  # fmt: skip


def row(state: State) -> tuple[float, ...]:
    """Return time, temperatures of centre, surface and mould, the mean gap and solid fraction."""
    T, T_mould = nodal(state, "casting", "temperature"), nodal(state, "mould", "temperature")
    r, r_mould = places(state, "casting")[:, 0], places(state, "mould")[:, 0]
    areas = pair_areas(state, "casting/mould")
    return (
        state.time,
        float(T[r == 0.0].mean()),
        float(T[r > RADIUS * (1 - 1e-9)].mean()),
        float(T_mould[r_mould < RADIUS * (1 + 1e-9)].mean()),
        float(areas @ paired(state, "casting/mould", "gap") / areas.sum()),
        state.totals["casting.solid_fraction"],
    )


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Follow the slice and compare its histories."""
    rows = [row(state) for state in states(comm, slice_case(at.size, at.step)) if state.step > 0]
    time, centre, surface, mould, gap, _ = np.transpose(rows)
    exact = reference(400, 0.01, time)
    answers, late = [], time >= 2.0
    found = {"centre": centre, "surface": surface, "mould": mould}
    for name, history in found.items():
        error = np.abs(history - exact[name])
        answers += [
            Answer.difference(f"temperature, {name}, from 2 s on", error[late].max(), "K", 2.5),
            Answer.difference(f"temperature, {name}", error.max(), "K", 5.0),
        ]
    off = np.abs(gap - exact["gap"])
    answers += [
        Answer.difference("gap, over 3 % or 1 µm", (off / np.maximum(0.03 * exact["gap"], 1e-6))
                          .max(), "", 1.0),
        Answer.relative("gap at 16 s", gap[-1], exact["gap"][-1], "m", 0.03),
    ]  # fmt: skip
    curves = tuple(Curve(name, time, history, time, exact[name]) for name, history in found.items())
    return Outcome(
        tuple(answers),
        float(off.mean() / exact["gap"][-1]),
        Comparison("time [s]", "temperature [°C]", curves),
    )


VERIFICATION = Verification(
    number="V20",
    title="A cylinder that solidifies in its mould behind an opening gap",
    formula="∂H/∂t = (1/r)(r k T')', h = min(h0, k/g), g = v(R) − u(R) of plane-strain "
    "thermo-elastic cylinders",
    source="after M. Chiumenti, section 10.2; a radial solution of its own: 400 elements each, "
    "steps of 0.01 s",
    run=compare,
    levels=tuple(Resolution(RADIUS / n, 4.0 / n) for n in (10, 20, 40)),
    quick=tuple(Resolution(RADIUS / n, 4.0 / n) for n in (10, 20)),
    norm="mean error of the gap over the gap at the end",
)
