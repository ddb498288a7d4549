"""V20 without ends: a slice of the cylinder against a one-dimensional solution of its own.

Between planes that do not move, the coupled cylinder depends on the radius only: enthalpy with an
isothermal front, plane-strain thermo-elasticity of a solid and a hollow cylinder, and an air gap
that throttles the heat, h = min(h0, k/g). The reference below solves these equations on its own
fine radial grid with small steps: linear elements in r, lumped enthalpy, Newton's method.

The demands are those of V20 at h = R/40 and Δt ≤ 0.1 s: 2.5 K (5 K for t < 2 s), and for the gap
3 % or 1 µm, whichever is larger.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import solve_banded

from tests.coupled_cases import cylinder, states

RADIUS, WALL, HEIGHT = 0.025, 0.02, 0.0025
MELT, POUR, START = 640.0, 655.0, 180.0
DENSITY, CAPACITY, LATENT, CONDUCTIVITY = 2600.0, 1100.0, 380e3, (180.0, 90.0)
YOUNG, POISSON, EXPANSION = (68e9, 8e9), 0.34, 2.5e-5
MOULD = {"density": 7700.0, "heat_capacity": 500.0, "conductivity": 30.0, "young_modulus": 200e9,
         "poisson_ratio": 0.28, "expansion": 1.1e-5}  # fmt: skip
CLOSED, GAS = 2600.0, 0.06
END = 16.0


@dataclass
class Cylinder1D:
    """Linear elements in the radius of a solid or hollow cylinder, per radian and unit height."""

    r: np.ndarray

    def __post_init__(self) -> None:
        self.length = np.diff(self.r)
        self.middle = (self.r[1:] + self.r[:-1]) / 2
        share = self.length * self.middle / 2
        self.volume = np.concatenate((share, [0.0])) + np.concatenate(([0.0], share))

    def conduction(self, k: np.ndarray) -> np.ndarray:
        """Return the tridiagonal matrix of ∫ k T' v' r dr, as bands."""
        g = k * self.middle / self.length
        bands = np.zeros((3, len(self.r)))
        bands[0, 1:], bands[2, :-1] = -g, -g
        bands[1, :-1] += g
        bands[1, 1:] += g
        return bands

    def displacement(self, young: np.ndarray, poisson: float, strain: np.ndarray) -> np.ndarray:
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
        return solve_banded((1, 1), bands, load)


def temperature_of(H: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return T, dT/dH and f_s of the metal; H = 0 is the solid at the melting point."""
    c, latent = DENSITY * CAPACITY, DENSITY * LATENT
    over = np.maximum(H - latent, 0.0)
    T = MELT + (np.minimum(H, 0.0) + over) / c
    slope = np.where((H < 0) | (H > latent), 1 / c, 0.0)
    return T, slope, np.clip(1 - H / latent, 0.0, 1.0)


def reference(cells: int, step: float, times: np.ndarray) -> dict[str, np.ndarray]:
    """Return histories: temperatures of both surfaces and of the centre, and the gap."""
    metal = Cylinder1D(np.linspace(0.0, RADIUS, cells + 1))
    die = Cylinder1D(RADIUS + WALL * np.linspace(0.0, 1.0, cells + 1) ** 1.5)
    n, c_die = cells + 1, MOULD["density"] * MOULD["heat_capacity"]
    volume = np.concatenate((metal.volume, die.volume))
    H = np.concatenate((np.full(n, DENSITY * (LATENT + CAPACITY * (POUR - MELT))),
                        np.full(n, START * c_die)))  # fmt: skip
    gap, rows = 0.0, []
    die_bands = die.conduction(np.full(cells, MOULD["conductivity"]))
    for _ in range(round(END / step)):
        old, h = H.copy(), min(CLOSED, GAS / gap) if gap > 0 else CLOSED
        for _ in range(40):
            T, slope, fraction = temperature_of(H[:n])
            k = CONDUCTIVITY[0] * fraction + CONDUCTIVITY[1] * (1 - fraction)
            bands = np.hstack((metal.conduction((k[1:] + k[:-1]) / 2), die_bands))
            exchange = h * RADIUS
            bands[1, n - 1] += exchange
            bands[1, n] += exchange
            bands[0, n], bands[2, n - 1] = -exchange, -exchange
            T = np.concatenate((T, H[n:] / c_die))
            flow = bands[1] * T
            flow[:-1] += bands[0, 1:] * T[1:]
            flow[1:] += bands[2, :-1] * T[:-1]
            balance = volume * (H - old) / step + flow
            if np.abs(balance).sum() < 1e-9 * np.abs(flow).sum():
                break
            matrix = bands * np.concatenate((slope, np.full(n, 1 / c_die)))
            matrix[1] += volume / step
            H = H - solve_banded((1, 1), matrix, balance)
        T_metal, T_die = temperature_of(H[:n])[0], H[n:] / c_die
        gap = opening(metal, die, T_metal, T_die)
        rows.append((T_metal[0], T_metal[-1], T_die[0], gap))
    time = step * np.arange(1, len(rows) + 1)
    names = ("centre", "surface", "mould", "gap")
    histories = zip(names, np.transpose(rows), strict=True)
    return {name: np.interp(times, time, history) for name, history in histories}


def opening(metal: Cylinder1D, die: Cylinder1D, T: np.ndarray, T_die: np.ndarray) -> float:
    """Return the gap between the free cylinders."""
    middle, middle_die = (T[1:] + T[:-1]) / 2, (T_die[1:] + T_die[:-1]) / 2
    young = np.interp(middle, (20.0, MELT), YOUNG)
    shrunk = EXPANSION * (np.minimum(T[1:], MELT) + np.minimum(T[:-1], MELT) - 2 * MELT) / 2
    u = metal.displacement(young, POISSON, shrunk)
    stiff = np.full_like(middle_die, MOULD["young_modulus"])
    v = die.displacement(stiff, MOULD["poisson_ratio"], MOULD["expansion"] * (middle_die - START))
    return float(v[0] - u[-1])


def case() -> dict:
    """Return the slice as a case."""
    metal = {
        "density": DENSITY, "heat_capacity": CAPACITY, "latent_heat": LATENT,
        "conductivity": {"solid": CONDUCTIVITY[0], "liquid": CONDUCTIVITY[1]},
        "solidus": MELT, "liquidus": MELT, "expansion": EXPANSION, "poisson_ratio": POISSON,
        "young_modulus": [[20.0, YOUNG[0]], [MELT, YOUNG[1]]],
    }  # fmt: skip
    made = cylinder(radius=RADIUS, height=HEIGHT, wall=WALL, size=RADIUS / 40)
    made["materials"] = {"aluminium": metal, "steel": MOULD}
    made["bodies"][0]["temperature"], made["bodies"][1]["temperature"] = POUR, START
    made["interfaces"][0]["heat"] = {"law": "limited", "closed": CLOSED, "gas_conductivity": GAS}
    made["boundaries"] = [
        {"on": f"{body}/{end}", "displacement": {"normal": 0.0}}
        for body in ("casting", "mould")
        for end in ("base", "top")
    ]
    made["time"] = {"end": END, "fixed_step": 0.1}
    return made


@pytest.mark.serial
def test_slice_follows_the_radial_solution(comm) -> None:
    rows = []
    for state in states(comm, case()):
        if state.step == 0:
            continue
        casting, mould = (state.mesh.bodies[name].points for name in ("casting", "mould"))
        T, T_mould = state.nodal("casting", "temperature"), state.nodal("mould", "temperature")
        on_axis, surface = casting[:, 0] == 0.0, casting[:, 0] > RADIUS * (1 - 1e-9)
        inside = mould[:, 0] < RADIUS * (1 + 1e-9)
        gap = state.paired("casting/mould", "gap")
        temperatures = (T[on_axis].mean(), T[surface].mean(), T_mould[inside].mean())
        rows.append((state.time, *temperatures, gap.mean()))
    time, centre, surface, mould, gap = np.transpose(rows)
    exact = reference(400, 0.005, time)
    for name, found in (("centre", centre), ("surface", surface), ("mould", mould)):
        error = np.abs(found - exact[name])
        assert error[time >= 2.0].max() < 2.5, name
        assert error.max() < 5.0, name
    assert (np.abs(gap - exact["gap"]) < np.maximum(0.03 * exact["gap"], 1e-6)).all()
    assert gap[-1] > 1.5 * GAS / CLOSED, "the gap throttles the heat"
