"""F1: foundry quantities of an alloy on a chilled wall, by similarity.

With η = x/√t the fronts stay at η_f, so that a solid fraction f passes x at t_f = x²/η_f². There
Ṫ = T'(η) η³/(2 x²) and G = T'(η) η/x, hence with λ2 = C Ṫ^(-1/3)

    G/√Ṫ = √(2 T'/η),   Ny* = C Ṫ^(-1/3) G/√Ṫ √(Δp_c/(μ β ΔT_f)) ~ x^(2/3),
    CSC = (1/η_0.99² − 1/η_0.9²)/(1/η_0.9² − 1/η_0.4²),

G, Ṫ at f = 0.9. Pores are (1 − ρ_l/ρ_s) g where 180 (1/g + 2 ln g − g) = Ny*² for f linear in T.
Niyama value: E. Niyama et al. (1982); Ny*: K. D. Carlson, C. Beckermann, Metall. Mater. Trans. A 40
(2009) 163; CSC: T. W. Clyne, G. J. Davies.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.case.reading.read import load_case
from castx.foundry.followed.foundry_fields import FoundryFields, poured_bodies, solidification_of
from castx.process.simulation import Simulation
from castx.proof.verification.heat.freezing_range import FreezingRange
from castx.proof.verification.heat.neumann import strip_case
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

AT = 0.9
"""Solid fraction at which gradient and cooling rate are taken."""


@dataclass(frozen=True)
class ChilledAlloy:
    """An alloy on a chilled wall with the data of its feeding; SI.

    Attributes:
        half_space: the heat.
        arms: C of λ2 = C Ṫ^(-1/3).
        viscosity: μ of the melt [Pa s].
        depression: Δp_c [Pa].
        contraction: β = (ρ_s − ρ_l)/ρ_l.
    """

    half_space: FreezingRange = field(default_factory=FreezingRange)
    arms: float = 4e-5
    viscosity: float = 1.2e-3
    depression: float = 1.01e5
    contraction: float = 0.0625

    @property
    def shrinkage(self) -> float:
        """S = β/(1 + β)."""
        return self.contraction / (1 + self.contraction)

    def passing(self, fraction: float) -> float:
        """Return 1/η_f², the time of passing over x² [s/m²]."""
        fronts = {1.0: self.half_space.fronts[0], 0.0: self.half_space.fronts[1]}
        eta = fronts[fraction] if fraction in fronts else self.half_space.place_of(fraction)
        return float(eta**-2)

    @property
    def freezing(self) -> float:
        """Local solidification time over x² [s/m²]."""
        return self.passing(1.0) - self.passing(0.0)

    def cooling_rate(self, x: FloatArray) -> FloatArray:
        """Return Ṫ at f = 0.9 [K/s]."""
        eta = self.half_space.place_of(AT)
        return np.asarray(self.half_space.gradient(eta) * eta**3 / (2 * x**2))

    def arm_spacing(self, x: FloatArray) -> FloatArray:
        """Return λ2 [m]."""
        return np.asarray(self.arms * self.cooling_rate(x) ** (-1 / 3))

    def dimensionless_niyama(self, x: FloatArray) -> FloatArray:
        """Return Ny*."""
        interval = self.half_space.liquidus - self.half_space.solidus
        feeding = self.depression / (self.viscosity * self.contraction * interval)
        return np.asarray(self.arm_spacing(x) * self.half_space.niyama(AT) * np.sqrt(feeding))

    def pore_fraction(self, x: FloatArray) -> FloatArray:
        """Return the volume of pores over the volume of solid."""
        values = np.atleast_1d(self.dimensionless_niyama(x))
        return self.shrinkage * np.array([critical_liquid(value) for value in values])

    @property
    def clyne_davies(self) -> float:
        """CSC by times."""
        late, middle, early = (self.passing(f) for f in (0.99, 0.9, 0.4))
        return (late - middle) / (middle - early)

    def case(self, at: Resolution, end: float) -> dict[str, Any]:
        """Return the case."""
        heat = self.half_space
        alloy = heat.material() | {
            "solidification_shrinkage": self.shrinkage,
            "melt_viscosity": self.viscosity,
            "arm_spacing": {"coefficient": self.arms},
            "cavitation": self.depression,
        }
        made = strip_case(alloy, heat.start, heat.wall, at, length=0.06, end=end)
        made["geometry"] |= {"width": 2 * at.size, "cells": "quadrilaterals"}
        made["time"]["largest_step"] = at.step
        return made | {"output": {"fields": list(FIELDS)}, "foundry": {"passing_times": [1.0]}}


def linear_suction(liquid: FloatArray) -> FloatArray:
    """Return I(g) = 180 (1/g + 2 ln g − g) for f linear in T."""
    return np.asarray(180 * (1 / liquid + 2 * np.log(liquid) - liquid))


def critical_liquid(niyama: float) -> float:
    """Return g of I(g) = Ny*²."""
    return float(brentq(lambda g: float(linear_suction(g)) - niyama**2, 1e-9, 1 - 1e-12))


FIELDS = ("niyama", "dimensionless_niyama", "pore_fraction", "clyne_davies", "arm_spacing",
          "solidification_time", "passing_times")  # fmt: skip
NEAR, FAR, END = 7e-3, 10.5e-3, 2.4
"""Places between which fields are compared [m], and when the last of them is solid [s]."""


def fields(
    comm: MPI.Intracomm, alloy: ChilledAlloy, at: Resolution
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return x and the fields of the nodes between the places, along x."""
    case = load_case(alloy.case(at, END))
    simulation = Simulation.from_case(case, comm)
    solidification = solidification_of(case, simulation.mesh)
    made = FoundryFields(solidification, poured_bodies(case))
    for state in simulation:
        solidification.update(state)
    body = simulation.mesh.bodies["casting"]
    owned = body.nodes.dofmap.index_map.size_local
    rows = {"x": body.points[:owned, 0], "front": made.nodal("casting", "passing_time_1.0")[:owned]}
    rows |= {name: made.nodal("casting", name)[:owned] for name in FIELDS[:-1]}
    simulation.destroy()
    found = {name: np.concatenate(comm.allgather(values)) for name, values in rows.items()}
    order = np.argsort(found["x"], kind="stable")
    order = order[(found["x"][order] > NEAR - 1e-6) & (found["x"][order] < FAR + 1e-6)]
    return found["x"][order], {name: values[order] for name, values in found.items()}


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Follow the fronts and compare the fields behind them."""
    alloy = ChilledAlloy()
    x, found = fields(comm, alloy, at)
    exact = {
        "niyama": np.full_like(x, alloy.half_space.niyama(AT)),
        "dimensionless_niyama": alloy.dimensionless_niyama(x),
        "pore_fraction": alloy.pore_fraction(x),
        "clyne_davies": np.full_like(x, alloy.clyne_davies),
        "arm_spacing": alloy.arm_spacing(x),
        "solidification_time": alloy.freezing * x**2,
        "front": alloy.passing(1.0) * x**2,
    }
    errors = {name: np.abs(found[name] / values - 1) for name, values in exact.items()}
    line = fine(NEAR, FAR)
    pores = 100 * found["pore_fraction"]
    curve = Curve("behind the front", x, pores, line, 100 * alloy.pore_fraction(line))
    return Outcome(
        (
            Answer.difference("Niyama value, mean", 100 * errors["niyama"].mean(), "%", 1.0),
            Answer.difference("Niyama value, largest", 100 * errors["niyama"].max(), "%", 3.0),
            Answer.difference("dimensionless Niyama value",
                              100 * errors["dimensionless_niyama"].max(), "%", 3.0),
            Answer.difference("pore fraction", 100 * errors["pore_fraction"].max(), "%", 3.0),
            Answer.difference("ratio of Clyne and Davies, mean",
                              100 * errors["clyne_davies"].mean(), "%", 2.0),
            Answer.difference("ratio of Clyne and Davies, largest",
                              100 * errors["clyne_davies"].max(), "%", 4.0),
            Answer.difference("arm spacing, mean", 100 * errors["arm_spacing"].mean(), "%", 1.0),
            Answer.difference("local solidification time, mean",
                              100 * errors["solidification_time"].mean(), "%", 3.5),
            Answer.difference("time of the solidus, mean", 100 * errors["front"].mean(), "%", 2.0),
        ),
        float(errors["front"].mean()),
        Comparison("distance from the wall [m]", "pore fraction [%]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="F1",
    title="Foundry quantities of an alloy on a chilled wall",
    formula="G/√Ṫ = √(2 T'/η), t_f = x² (1/η_S² − 1/η_L²), Ny* ~ x^(2/3), "
    "180 (1/g + 2 ln g − g) = Ny*², CSC by times of f = 0.4, 0.9, 0.99",
    source="the similarity solution of V3; K. D. Carlson, C. Beckermann, Metall. Mater. Trans. A "
    "40 (2009) 163; T. W. Clyne, G. J. Davies",
    run=compare,
    levels=(Resolution(1e-3, 0.04), Resolution(0.5e-3, 0.02)),
    quick=(Resolution(1e-3, 0.04), Resolution(0.5e-3, 0.02)),
    norm="mean relative error of the time of the solidus",
)
