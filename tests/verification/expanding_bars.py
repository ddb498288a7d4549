"""V19, its exact answer: two bars that expand towards each other, with h(p) or h(g) between them.

Steady state, ν = 0, far ends at T1, T2 and held, sides held in their normals: one equation for the
overlap x = expansion of both bars − initial gap,

    x ≤ 0: g = −x, p = 0, h = min(h0, k/g);    x > 0: g = 0, p = x / (L1/E1 + L2/E2),
    h = h0 + (1/R)(p/H_e)^b;    q = h (T_c − T_m) + φσ (T_c⁴ − T_m⁴) with the face temperatures
    T_c = T1 − q L1/k1 and T_m = T2 + q L2/k2; without radiation (T1 − T2)/(L1/k1 + 1/h + L2/k2),

the expansion of each bar being α L (T̄ − 20), T̄ the mean of its end temperatures. It is solved here
by bisection; law and numbers of the first case after Chiumenti, section 9 (Yovanovich's form). With
the law "series" h = 1/(1/h0 + g/k) when open; h0 may depend on T_c, and R follow from roughness and
a coating.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.process.state import State
from tests import coupled_cases

INTERFACE = "casting/mould"
FIELDS = {"p": "contact_pressure", "h": "heat_transfer_coefficient", "gap": "gap"}
REFERENCE = 20.0


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
    law: str = "limited"
    emissivities: tuple[float, float] | None = None
    slope: float = 0.0  # dh0/dT_c; h0 is `closed` at 0 °C
    roughness: tuple[float, float] | None = None
    coating: tuple[float, float] = (2e-4, 0.8)

    def exact(self) -> dict[str, float]:
        """Return gap, pressure, coefficient, flux and face temperatures."""
        overlap = brentq(lambda x: self._state(x)["overlap"] - x, -self.gap, 1e-2, xtol=1e-18)
        return self._state(overlap)

    def _state(self, overlap: float) -> dict[str, float]:
        (L1, L2), (k1, k2), (E1, E2) = self.lengths, self.conductivity, self.young
        gap, p = max(-overlap, 0.0), max(overlap, 0.0) / (L1 / E1 + L2 / E2)

        def faces(q: float) -> tuple[float, float]:
            return self.ends[0] - q * L1 / k1, self.ends[1] + q * L2 / k2

        def excess(q: float) -> float:
            Tc, Tm = faces(q)
            return self._coefficient(gap, p, Tc) * (Tc - Tm) + self._radiation(Tc, Tm) - q

        q = brentq(excess, 0.0, (self.ends[0] - self.ends[1]) / (L1 / k1 + L2 / k2), xtol=1e-9)
        means = np.add(self.ends, faces(q)) / 2
        grown = float(np.array(self.expansion) * self.lengths @ (means - REFERENCE))
        return {"gap": gap, "p": p, "h": self._coefficient(gap, p, faces(q)[0]), "q": q,
                "casting": faces(q)[0], "mould": faces(q)[1],
                "overlap": grown - self.gap}  # fmt: skip

    def _coefficient(self, gap: float, p: float, Tc: float) -> float:
        h = self.closed + self.slope * Tc
        if gap > 0:
            h = min(h, self.gas / gap) if self.law == "limited" else 1 / (1 / h + gap / self.gas)
        return h + (p / self.hardness) ** self.exponent / self.contact_resistance

    @property
    def contact_resistance(self) -> float:
        if self.roughness is None:
            return self.resistance
        depth = 0.5 * (self.roughness[0] ** 2 + self.roughness[1] ** 2) ** 0.5
        return depth / self.gas + self.coating[0] / self.coating[1]

    def _radiation(self, Tc: float, Tm: float) -> float:
        if self.emissivities is None:
            return 0.0
        e1, e2 = self.emissivities
        fourth = (Tc + 273.15) ** 4 - (Tm + 273.15) ** 4
        return 5.670374419e-8 * fourth / (1 / e1 + 1 / e2 - 1)

    def heat(self) -> dict:
        """Return the law as a case describes it."""
        pressure = {"hardness": self.hardness, "exponent": self.exponent}
        heat = {"law": self.law, "closed": self.closed, "gas_conductivity": self.gas,
                "pressure": pressure}  # fmt: skip
        if self.roughness is None:
            pressure["resistance"] = self.resistance
        else:
            heat["roughness"] = list(self.roughness)
            heat["coating"] = {"thickness": self.coating[0], "conductivity": self.coating[1]}
        if self.slope:
            table = [[0.0, self.closed], [1000.0, self.closed + 1000.0 * self.slope]]
            heat["closed"] = {"over": "temperature", "table": table}
        if self.emissivities is not None:
            heat["radiation"] = {"emissivities": list(self.emissivities)}
        return heat


GIVEN = Bars()
OPEN = replace(GIVEN, gap=7e-4, gas=0.06, ends=(420.0, 35.0))
HOT = replace(GIVEN, lengths=(0.03, 0.02), young=(60e9, 120e9), ends=(380.0, 60.0), gap=2e-4,
              closed=1500.0, resistance=4e-5)  # fmt: skip
GLOWING = replace(OPEN, ends=(900.0, 120.0), gap=2e-3, emissivities=(0.7, 0.9))
GLOWING_SERIES = replace(GLOWING, law="series", slope=1.5)
GLOWING_CLOSED = replace(HOT, ends=(700.0, 60.0), emissivities=(0.9, 0.8), slope=-0.8)
ROUGH = replace(GIVEN, roughness=(25e-6, 60e-6), exponent=0.7, law="series")


def bars_case(bars: Bars, model: str, size: float, seconds: float = 3e6) -> dict[str, Any]:
    """Return the case, followed until it is steady; nothing is said of how it is solved."""
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
            {"name": name, "material": name, "temperature": end}
            for name, end in zip(names, bars.ends, strict=True)
        ],
        "interfaces": [
            {"bodies": list(names), "contact": {"initial_gap": bars.gap},
             "heat": bars.heat()},
        ],
        "boundaries": held,
        "time": {"end": seconds},
    }  # fmt: skip


def answers(states: Iterable[State]) -> dict[str, FloatArray]:
    """Return the answers at all pairs, their areas, the flux and the resultant over the area."""
    heats, times = [], []
    for state in states:
        heats.append(state.totals[f"{INTERFACE}.heat"])
        times.append(state.time)
    assert state.counters.cutbacks == 0
    comm = state.mesh.comm
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
    found["q"] = np.array([(heats[-1] - heats[-2]) / ((times[-1] - times[-2]) * area)])
    found["force"] = np.array([state.totals[f"{INTERFACE}.force.x"] / area])
    return found


def mean(found: dict[str, np.ndarray], key: str) -> float:
    return float(found["areas"] @ found[key] / found["areas"].sum())
