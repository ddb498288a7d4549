"""V19: two bars that expand towards each other, with h(p) or h(g) between them.

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

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq

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
        return float(h + (p / self.hardness) ** self.exponent / self.contact_resistance)

    @property
    def contact_resistance(self) -> float:
        """R, given or that of roughness and coating."""
        if self.roughness is None:
            return self.resistance
        depth = 0.5 * (self.roughness[0] ** 2 + self.roughness[1] ** 2) ** 0.5
        return float(depth / self.gas + self.coating[0] / self.coating[1])

    def _radiation(self, Tc: float, Tm: float) -> float:
        if self.emissivities is None:
            return 0.0
        e1, e2 = self.emissivities
        fourth = (Tc + 273.15) ** 4 - (Tm + 273.15) ** 4
        return 5.670374419e-8 * fourth / (1 / e1 + 1 / e2 - 1)

    def heat(self) -> dict[str, Any]:
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


def answers(run: Iterable[State]) -> dict[str, FloatArray]:
    """Return the results at the end of a run.

    Returns:
        p, h and gap of all pairs and their areas; temperatures of both faces; the flux "q" and the
        resultant "force" over the area; tries in vain of the last step; x and T of all nodes.
    """
    heats, times = [], []
    for state in run:
        heats.append(state.totals[f"{INTERFACE}.heat"])
        times.append(state.time)
    found = {key: paired(state, INTERFACE, name) for key, name in FIELDS.items()}
    found["areas"] = pair_areas(state, INTERFACE)
    x, T = [], []
    for body in ("mould", "casting"):
        x.append(places(state, body)[:, 0])
        T.append(nodal(state, body, "temperature"))
        found[body] = T[-1][np.abs(x[-1]) < 1e-9]
    found["x"], found["T"] = np.concatenate(x), np.concatenate(T)
    area = found["areas"].sum()
    found["q"] = np.array([(heats[-1] - heats[-2]) / ((times[-1] - times[-2]) * area)])
    found["force"] = np.array([state.totals[f"{INTERFACE}.force.x"] / area])
    found["cutbacks"] = np.array([float(state.counters.cutbacks)])
    return found


def mean(found: Mapping[str, FloatArray], key: str) -> float:
    """Return the mean of a quantity of pairs, weighted by their areas."""
    return float(found["areas"] @ found[key] / found["areas"].sum())


def answers_beside(bars: Bars, found: Mapping[str, FloatArray], what: str) -> list[Answer]:
    """Return the results of a run of bars beside the exact numbers."""
    exact, face = bars.exact(), {name: found[name].mean() for name in ("casting", "mould")}
    made = [
        Answer.relative(f"coefficient, {what}", mean(found, "h"), exact["h"], "W/m²/K", 1e-4),
        Answer.relative(f"flux, {what}", found["q"][0], exact["q"], "W/m²", 1e-4),
        Answer.relative(f"face of the casting, {what}", face["casting"], exact["casting"], "°C",
                        1e-4),
        Answer.relative(f"face of the mould, {what}", face["mould"], exact["mould"], "°C", 1e-4),
    ]  # fmt: skip
    if exact["gap"] > 0:
        gap = mean(found, "gap")
        return [Answer.relative(f"gap, {what}", gap, exact["gap"], "m", 1e-4), *made]
    pressure = mean(found, "p")
    return [Answer.relative(f"contact pressure, {what}", pressure, exact["p"], "Pa", 1e-4), *made]


TIGHT = {
    "coupling": {"tolerance": 1e-9},
    "solver": {"linear": "direct", "mechanics_tolerance": 1e-11, "heat_tolerance": 1e-11},
}
"""Solver of a case whose answers are compared to many digits."""


def steady_case(bars: Bars, model: str, size: float) -> dict[str, Any]:
    """Return the case in large steps to the steady state."""
    steps = {"fixed_step": 1e6, "first_step": 1.0, "heat_substeps": 1}
    case = bars_case(bars, model, size)
    return {**case, **TIGHT, "time": {**case["time"], **steps}}


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run closed and open bars to the steady state and compare."""
    made: list[Answer] = []
    curves: list[Curve] = []
    pressures: FloatArray = np.empty(0)
    for bars, what in ((GIVEN, "closed"), (OPEN, "open")):
        found = answers(states(comm, steady_case(bars, "plane-strain", at.size)))
        made += answers_beside(bars, found, what)
        pressures = found["p"] if bars is GIVEN else pressures
        curves.append(temperature_curve(bars, found, what))
    return Outcome(
        tuple(made),
        float(np.abs(pressures / GIVEN.exact()["p"] - 1).max()),
        Comparison("distance from the interface [m]", "temperature [°C]", tuple(curves)),
    )


def temperature_curve(bars: Bars, found: Mapping[str, FloatArray], what: str) -> Curve:
    """Return the temperature along both bars; exact are the straight lines to their ends."""
    exact, (L1, L2), (T1, T2) = bars.exact(), bars.lengths, bars.ends
    order = np.argsort(found["x"], kind="stable")
    x, T = np.array([-L2, 0.0, 0.0, L1]), np.array([T2, exact["mould"], exact["casting"], T1])
    return Curve(what, found["x"][order], found["T"][order], x, T)


VERIFICATION = Verification(
    number="V19",
    title="Two bars with a gap or a contact that conducts by its pressure",
    formula="closed p = x/(L1/E1 + L2/E2), h = h0 + (1/R)(p/H_e)^b; open g = −x, h = min(h0, k/g); "
    "q = (T1 − T2)/(L1/k1 + 1/h + L2/k2), x the expansion of both bars minus the initial gap",
    source="law after M. Chiumenti, section 9 (Yovanovich); one equation for x, solved by "
    "bisection",
    run=compare,
    levels=(Resolution(0.01), Resolution(0.005), Resolution(0.0025)),
    quick=(Resolution(0.01), Resolution(0.005)),
    norm="largest relative error of the pressure of a pair",
)
