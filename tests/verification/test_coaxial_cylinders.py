"""Coaxial cylinders between given temperatures: gap or pressure, heat transfer and expansion agree.

A cylinder with a bore (radii r₁, a) inside a ring (a, r₂), both held at their ends (ε_z = 0); the
temperatures are T₁ at the bore and T₂ outside. In the steady state the heat per length 2πQ gives
logarithmic profiles,

    T = T₁ − (Q/k₁) ln(r/r₁),    T = T₂ + (Q/k₂) ln(r₂/r),

with the faces T_c, T_r at r = a. Free thermal expansion moves both faces at a by
2(1 + ν) α a ∫(T − T₀) r dr / (r_o² − r_i²), and a contact pressure p by −p C₁ and p C₂ with
C = (1 + ν) a ((1 − 2ν) a² + r²)/(E |a² − r²|), r the other radius (S. P. Timoshenko, J. N. Goodier,
Theory of Elasticity, sections 28 and 151). Hence the opening x(Q) = g₀ + u₂ − u₁, linear in Q, the
gap max(x, 0), the pressure max(−x, 0)/(C₁ + C₂), and one scalar equation,

    F(Q) = Q/(a h(g, p)) − (T_c − T_r) = 0,    h = min(h₀, k/g) + (1/R)(p/H)^b.

Heat that flows inwards warms the core, which closes the gap, which lets more heat pass: F may have
three roots, of which the middle one is unstable (J. R. Barber, J. Dundurs, M. Comninou, Journal of
Applied Mechanics 47 (1980)). Heat that flows outwards has one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import brentq

from tests import coupled_cases

pytestmark = pytest.mark.sampled

INTERFACE = "casting/core"


@dataclass(frozen=True)
class Cylinders:
    """Data of core and ring, and of the law between them."""

    radii: tuple[float, float, float] = (0.01, 0.03, 0.05)
    conductivity: tuple[float, float] = (60.0, 60.0)
    young: tuple[float, float] = (70e9, 70e9)
    poisson: tuple[float, float] = (0.33, 0.33)
    expansion: tuple[float, float] = (2.3e-5, 2.3e-5)
    ends: tuple[float, float] = (30.0, 480.0)
    reference: float = 20.0
    gap: float = -250e-6
    closed: float = 4000.0
    gas: float = 0.03
    resistance: float = 5e-5
    hardness: float = 1e9
    exponent: float = 0.95

    def state(self, Q: float) -> dict[str, float]:
        """Return faces, gap, pressure and coefficient at a heat Q [W/m per radian]."""
        r1, a, r2 = self.radii
        (k1, k2), (n1, n2), (E1, E2) = self.conductivity, self.poisson, self.young
        core = self.ends[0] - Q / k1 * np.log(a / r1)
        ring = self.ends[1] + Q / k2 * np.log(r2 / a)
        moved = []
        for inner, outer, start, k, nu, alpha in (
            (r1, a, self.ends[0], k1, n1, self.expansion[0]),
            (a, r2, ring, k2, n2, self.expansion[1]),
        ):
            area = (outer**2 - inner**2) / 2
            integral = (start - self.reference) * area
            integral -= Q / k * (outer**2 / 2 * np.log(outer / inner) - area / 2)
            moved.append(2 * (1 + nu) * alpha * a * integral / (2 * area))
        opening = self.gap + moved[1] - moved[0]
        yields = sum(
            (1 + nu) / E * a * ((1 - 2 * nu) * a**2 + r**2) / abs(a**2 - r**2)
            for nu, E, r in ((n1, E1, r1), (n2, E2, r2))
        )
        gap, p = max(opening, 0.0), max(-opening, 0.0) / yields
        h = min(self.closed, self.gas / gap) if gap > 0 else self.closed
        h += (p / self.hardness) ** self.exponent / self.resistance
        return {"core": core, "casting": ring, "gap": gap, "p": p, "h": h}

    def excess(self, Q: float) -> float:
        """Return F(Q)."""
        at = self.state(Q)
        return Q / (self.radii[1] * at["h"]) - (at["core"] - at["casting"])

    def roots(self) -> list[float]:
        """Return all roots of F, those that pass less heat first."""
        r1, a, r2 = self.radii
        resistance = np.log(a / r1) / self.conductivity[0] + np.log(r2 / a) / self.conductivity[1]
        grid = np.linspace(0.0, (self.ends[0] - self.ends[1]) / resistance, 4001)
        F = np.array([self.excess(Q) for Q in grid])
        change = np.flatnonzero(F[:-1] * F[1:] < 0)
        return [brentq(self.excess, grid[i], grid[i + 1], xtol=1e-9) for i in change]

    def is_stable(self, Q: float) -> bool:
        """Whether more heat than Q is more than the temperatures drive: F grows with Q."""
        return (self.excess(Q + 1e-3) - self.excess(Q - 1e-3)) > 0


INWARD = Cylinders()
OUTWARD = replace(INWARD, ends=(350.0, 40.0), gap=250e-6)
PRESSED = replace(OUTWARD, gap=-5e-4, conductivity=(120.0, 40.0), young=(200e9, 100e9),
                  expansion=(1.2e-5, 2.0e-5), poisson=(0.28, 0.33))  # fmt: skip


def case(given: Cylinders, start: tuple[float, float], size: float) -> dict:
    """Return the case: a disc one element high; `start` are temperatures of core and ring."""
    names, surfaces = ("core", "casting"), ("bore", "outside")
    level = [f"{name}/{end}" for name in names for end in ("base", "top")]
    held = [{"on": surface, "displacement": {"normal": 0}} for surface in level]
    for name, surface, end in zip(names, surfaces, given.ends, strict=True):
        held.append({"on": f"{name}/{surface}", "heat": {"type": "temperature", "value": end}})
    pressure = {"resistance": given.resistance, "hardness": given.hardness,
                "exponent": given.exponent}  # fmt: skip
    return {
        "geometry": {"generator": "core_in_ring", "model": "axisymmetric", "size": size,
                     "core_bore": given.radii[0], "core_radius": given.radii[1],
                     "outer_radius": given.radii[2], "height": size},
        "materials": {
            name: {"density": 1000.0, "heat_capacity": 1000.0, "conductivity": k,
                   "young_modulus": E, "poisson_ratio": nu, "expansion": alpha,
                   "stress_free": given.reference}
            for name, k, E, nu, alpha in zip(names, given.conductivity, given.young, given.poisson,
                                             given.expansion, strict=True)
        },
        "bodies": [
            {"name": name, "material": name, "temperature": T, "formulation": "displacement"}
            for name, T in zip(names, start, strict=True)
        ],
        "interfaces": [
            {"bodies": ["casting", "core"],
             "contact": {"method": "condensed", "initial_gap": given.gap},
             "heat": {"law": "limited", "closed": given.closed, "gas_conductivity": given.gas,
                      "pressure": pressure}},
        ],
        "boundaries": held,
        "time": {"end": 300.0, "first_step": 0.1, "largest_step": 20.0, "heat_substeps": 1,
                 "temperature_change": 50.0},
        "coupling": {"tolerance": 1e-5},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-8},
    }  # fmt: skip


def solve(comm, given: Cylinders, start, size: float = 0.002) -> dict[str, float]:
    """Return the state at the end of a run, means over the interface."""
    state = coupled_cases.final_state(comm, case(given, start, size))
    pairs = state.pairs[INTERFACE]
    found = {}
    fields = {"gap": "gap", "p": "contact_pressure", "h": "heat_transfer_coefficient"}
    area = comm.allreduce(float(pairs.areas.sum()))
    for key, name in fields.items():
        found[key] = comm.allreduce(float(pairs.areas @ state.paired(INTERFACE, name))) / area
    for body in ("core", "casting"):
        points = coupled_cases.places(state, body)
        T = coupled_cases.nodal(state, body, "temperature")
        radius = coupled_cases.ordered(comm, points, points[:, 0].copy())
        found[body] = float(T[np.abs(radius - given.radii[1]) < 1e-9].mean())
    powers = [state.totals[f"{name}.power"] for name in ("core/bore", "casting/outside")]
    assert powers[0] == pytest.approx(-powers[1], rel=1e-5)  # steady
    found["Q"] = powers[0] / (2 * np.pi * size)
    return found


def check(given: Cylinders, found: dict[str, float], root: float) -> None:
    exact = given.state(root)
    assert found["Q"] == pytest.approx(root, rel=0.01)
    for face in ("core", "casting"):
        assert found[face] == pytest.approx(exact[face], abs=1.5)
    assert found["gap"] == pytest.approx(exact["gap"], rel=0.02, abs=1e-12)
    assert found["p"] == pytest.approx(exact["p"], rel=0.02)
    assert found["h"] == pytest.approx(exact["h"], rel=0.02)


def test_both_stable_states_and_none_between(comm):
    """Where the ring alone is hot they stay apart, where both are they stay closed."""
    roots = INWARD.roots()
    assert [INWARD.is_stable(Q) for Q in roots] == [True, False, True]
    states = [INWARD.state(Q) for Q in roots]
    assert states[0]["gap"] > 100e-6 and states[2]["p"] > 10e6
    check(INWARD, solve(comm, INWARD, (20.0, 480.0)), roots[0])
    check(INWARD, solve(comm, INWARD, (300.0, 400.0)), roots[2])


@pytest.mark.parametrize("given", [OUTWARD, PRESSED])
def test_one_state_where_heat_flows_outwards(comm, given):
    roots = given.roots()
    assert len(roots) == 1 and given.is_stable(roots[0])
    assert (given.state(roots[0])["gap"] > 1e-6) == (given is OUTWARD)
    check(given, solve(comm, given, (20.0, 20.0)), roots[0])


def test_errors_fall_with_the_element_size(comm):
    root = OUTWARD.roots()[0]
    exact = OUTWARD.state(root)
    found = [solve(comm, OUTWARD, (20.0, 20.0), size) for size in (0.004, 0.002)]
    for key in ("gap", "core"):
        errors = [abs(state[key] - exact[key]) for state in found]
        assert errors[0] / errors[1] > 1.6, key
