"""V19: two bars that expand towards each other, with h(p) or h(g) between them.

Steady state, ν = 0, far ends at T1, T2 and held, sides held in their normals: one equation for the
overlap x = expansion of both bars − initial gap,

    x ≤ 0: g = −x, p = 0, h = min(h0, k/g);    x > 0: g = 0, p = x / (L1/E1 + L2/E2),
    h = h0 + (1/R)(p/H_e)^b;    q = (T1 − T2) / (L1/k1 + 1/h + L2/k2),

the expansion of each bar being α L (T̄ − 20), T̄ the mean of its end temperatures. It is solved here
by bisection; law and numbers of the first case after Chiumenti, section 9 (Yovanovich's form).

The mean pressure and the resultant are exact on any mesh. Pair by pair the pressure of linear
elements alternates with the diagonals of the cells, since the thermal strain varies inside them: by
O(h).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import brentq

from tests import coupled_cases

INTERFACE = "casting/mould"
FIELDS = {"p": "contact_pressure", "h": "heat_transfer_coefficient", "gap": "gap"}
REFERENCE = 20.0
SIZES = (0.005, 0.0025)


@dataclass(frozen=True)
class Bars:
    """Data of both bars (first the casting) and of the law between them."""

    lengths: tuple[float, float] = (0.05, 0.08)
    conductivity: tuple[float, float] = (150.0, 50.0)
    young: tuple[float, float] = (70e9, 210e9)
    expansion: tuple[float, float] = (2.3e-5, 1.2e-5)
    ends: tuple[float, float] = (300.0, 20.0)
    gap: float = 1e-4
    closed: float = 800.0
    gas: float = 0.04
    resistance: float = 1.6666667e-5
    hardness: float = 1.2e9
    exponent: float = 0.95

    def exact(self) -> dict[str, float]:
        """Return gap, pressure, coefficient, flux and face temperatures."""
        overlap = brentq(lambda x: self._state(x)["overlap"] - x, -self.gap, 1e-2, xtol=1e-18)
        return self._state(overlap)

    def _state(self, overlap: float) -> dict[str, float]:
        (L1, L2), (k1, k2), (E1, E2) = self.lengths, self.conductivity, self.young
        gap, p = max(-overlap, 0.0), max(overlap, 0.0) / (L1 / E1 + L2 / E2)
        h = min(self.closed, self.gas / gap) if gap > 0 else self.closed
        h += (p / self.hardness) ** self.exponent / self.resistance
        q = (self.ends[0] - self.ends[1]) / (L1 / k1 + 1 / h + L2 / k2)
        faces = self.ends[0] - q * L1 / k1, self.ends[1] + q * L2 / k2
        grown = sum(
            a * L * (0.5 * (end + face) - REFERENCE)
            for a, L, end, face in zip(self.expansion, self.lengths, self.ends, faces, strict=True)
        )
        return {"gap": gap, "p": p, "h": h, "q": q, "casting": faces[0], "mould": faces[1],
                "overlap": grown - self.gap}  # fmt: skip


GIVEN = Bars()
OPEN = replace(GIVEN, gap=7e-4, gas=0.06, ends=(420.0, 35.0))
HOT = replace(GIVEN, lengths=(0.03, 0.02), young=(60e9, 120e9), ends=(380.0, 60.0), gap=2e-4,
              closed=1500.0, resistance=4e-5)  # fmt: skip


def case(bars: Bars, model: str, formulation: str, method: str, size: float) -> dict:
    """Return the case: large steps to the steady state, tight tolerances."""
    names = ("casting", "mould")
    geometry = {
        "generator": "two_slabs", "model": model, "length": bars.lengths[0],
        "mould_length": bars.lengths[1], "width": 2 * size, "size": size,
    }  # fmt: skip
    sides = ["bottom", "top"]
    if model == "3d":
        geometry["depth"] = 2 * size
        sides += ["front", "back"]
    held = [{"on": f"{n}/{s}", "displacement": {"normal": 0.0}} for n in names for s in sides]
    for name, end in zip(names, bars.ends, strict=True):
        heat = {"type": "temperature", "value": end}
        held.append({"on": f"{name}/far", "heat": heat, "displacement": {"normal": 0.0}})
    pressure = {
        "resistance": bars.resistance, "hardness": bars.hardness, "exponent": bars.exponent,
    }  # fmt: skip
    return {
        "geometry": geometry,
        "materials": {
            name: {
                "density": 1000.0, "heat_capacity": 1000.0, "conductivity": bars.conductivity[i],
                "young_modulus": bars.young[i], "poisson_ratio": 0.0,
                "expansion": bars.expansion[i], "stress_free": REFERENCE,
            }
            for i, name in enumerate(names)
        },
        "bodies": [
            {"name": name, "material": name, "temperature": end, "formulation": formulation}
            for name, end in zip(names, bars.ends, strict=True)
        ],
        "interfaces": [
            {"bodies": list(names), "contact": {"method": method, "initial_gap": bars.gap},
             "heat": {"law": "limited", "closed": bars.closed, "gas_conductivity": bars.gas,
                      "pressure": pressure}},
        ],
        "boundaries": held,
        "time": {"end": 3e6, "fixed_step": 1e6, "first_step": 1.0, "heat_substeps": 1},
        "coupling": {"tolerance": 1e-9},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-11, "heat_tolerance": 1e-11},
    }  # fmt: skip


def solve(
    comm, bars: Bars, model="plane-strain", formulation="mixed", method="condensed", size=0.005
) -> dict[str, np.ndarray]:
    """Return the answers at all pairs, their areas, the flux and the resultant over the area."""
    heats = []
    for state in coupled_cases.states(comm, case(bars, model, formulation, method, size)):
        heats.append(state.totals[f"{INTERFACE}.heat"])
    assert state.counters.cutbacks == 0
    pairs = state.pairs[INTERFACE]
    found = {
        key: np.concatenate(comm.allgather(state.paired(INTERFACE, name)))
        for key, name in FIELDS.items()
    }
    found["areas"] = np.concatenate(comm.allgather(pairs.areas))
    for body in ("casting", "mould"):
        points, values = coupled_cases.places(state, body), state.nodal(body, "temperature")
        face = np.abs(points[:, 0]) < 1e-9
        found[body] = np.concatenate(comm.allgather(values[: len(points)][face]))
    area = found["areas"].sum()
    found["q"] = np.array([(heats[-1] - heats[-2]) / (1e6 * area)])
    found["force"] = np.array([state.totals[f"{INTERFACE}.force.x"] / area])
    return found


def mean(found: dict[str, np.ndarray], key: str) -> float:
    return float(found["areas"] @ found[key] / found["areas"].sum())


@pytest.mark.parametrize(
    "bars, options",
    [
        (GIVEN, {}),
        (GIVEN, {"formulation": "displacement"}),
        (GIVEN, {"method": "multipliers"}),
        (GIVEN, {"model": "plane-stress"}),
        (GIVEN, {"model": "3d", "size": 0.01}),
        (HOT, {"size": 0.0025}),
    ],
)
def test_closed_bars(comm, bars, options):
    found, exact = solve(comm, bars, **options), bars.exact()
    assert found["gap"] == pytest.approx(0.0, abs=1e-12)
    assert mean(found, "p") == pytest.approx(exact["p"], rel=1e-4)
    assert found["force"][0] == pytest.approx(exact["p"], rel=1e-4)  # towards the casting, +x
    assert mean(found, "h") == pytest.approx(exact["h"], rel=1e-4)
    assert found["q"][0] == pytest.approx(exact["q"], rel=1e-4)
    for face in ("casting", "mould"):
        assert found[face] == pytest.approx(exact[face], rel=1e-4)


@pytest.mark.parametrize(
    "options", [{}, {"formulation": "displacement"}, {"method": "multipliers"}]
)
def test_open_bars(comm, options):
    found, exact = solve(comm, OPEN, **options), OPEN.exact()
    assert 0 < exact["h"] < OPEN.closed  # the gap rules
    assert found["p"] == pytest.approx(0.0, abs=0.0)
    assert found["gap"] == pytest.approx(exact["gap"], rel=1e-4)
    assert found["h"] == pytest.approx(exact["h"], rel=1e-4)
    assert found["q"][0] == pytest.approx(exact["q"], rel=1e-4)
    for face in ("casting", "mould"):
        assert found[face] == pytest.approx(exact[face], rel=1e-4)


def test_pressures_of_the_pairs_converge(comm):
    errors = [np.abs(solve(comm, GIVEN, size=h)["p"] / GIVEN.exact()["p"] - 1) for h in SIZES]
    assert errors[0].max() < 1.5e-3
    assert errors[0].max() / errors[1].max() > 1.6


def test_given_numbers():
    exact = GIVEN.exact()
    assert exact["p"] == pytest.approx(276.472197e6, rel=1e-8)
    assert exact["h"] == pytest.approx(15676.404, rel=1e-7)
    assert exact["q"] == pytest.approx(140201.647, rel=1e-8)
    assert (exact["casting"], exact["mould"]) == pytest.approx((253.2661, 244.3226), rel=1e-6)
