"""Layers of a plate that freeze, melt and freeze again, and what they bear: in one dimension.

The plate is that of `castx/proof/verification/solids/freezing_plate.py`: lengths in L, times in
L²/a, temperatures over the melting point in ΔT. Its layers are the control volumes of the nodes of
a fine grid. A layer is solid as soon as half of it is frozen, and has no past then: no strain, no
flow, no hardening; of the step in which it is born half strains it. All have one lateral strain ε,
and no force acts along the plate,

    σ = M (ε − ε_birth − ε_vp − α (T − T_birth)),   Σ V σ = 0.

Free in both lateral directions: M = E/(1 − ν), and ε_vp = γ/2 for a flow γ along the stress, since
its deviator is σ (−2/3, 1/3, 1/3). Free in one and without stress in the other (plane stress):
M = E and ε_vp = γ. In both the equivalents of stress and flow are |σ| and |γ|, that of the back
stress is H_k |γ|, and a step returns to |σ − H_k γ| = σ_Y(T) + H ξ + η Δξ/Δt.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from castx.arrays import BoolArray, FloatArray
from castx.proof.verification.solids.freezing_plate import (
    CAPACITY,
    CONDUCTIVITY,
    DENSITY,
    EXPANSION,
    LENGTH,
    POISSON,
    SPAN,
    YOUNG,
    Plate,
)
from tests.verification.freezing_grid import freezing

SECONDS = LENGTH**2 * DENSITY * CAPACITY / CONDUCTIVITY
"""In one of the dimensionless times."""


@dataclass(frozen=True)
class Metal:
    """What a frozen layer bears; without a yield stress it is elastic.

    Attributes:
        cold: σ_Y at T_m − ΔT [Pa].
        hot: at T_m [Pa]; linear between both.
        hardening: H [Pa].
        kinematic: H_k [Pa].
        viscosity: η of Perzyna's rule with exponent 1 [Pa s].
    """

    cold: float = np.inf
    hot: float = np.inf
    hardening: float = 0.0
    kinematic: float = 0.0
    viscosity: float = 0.0

    def strength(self, temperature: FloatArray) -> FloatArray:
        if np.isinf(self.cold):
            return np.full(len(temperature), np.inf)
        return self.hot - temperature * (self.cold - self.hot)


@dataclass(frozen=True)
class Layers:
    """A plate, and a grid for its answer.

    Attributes:
        plate: Biot and Stefan number, time and steps.
        metal: of its solid.
        ambient: temperature of what cools or heats it over time, (T − T_m)/ΔT.
        plane_stress: whether one lateral direction is without stress.
        cells: of the grid.
    """

    plate: Plate
    metal: Metal = field(default_factory=Metal)
    ambient: Callable[[float], float] = lambda time: -1.0
    plane_stress: bool = False
    cells: int = 480

    @property
    def volumes(self) -> FloatArray:
        found = np.full(self.cells + 1, 1.0 / self.cells)
        found[[0, -1]] *= 0.5
        return found

    def stress(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return ε over time, and stress [Pa] and ξ of the layers at the end."""
        temperature, fraction = freezing(self.plate, self.cells, self.ambient)
        temperature = np.minimum(temperature, 0.0)
        layers, step = _Frozen(self), self.plate.end / self.plate.steps * SECONDS
        strain = [0.0]
        solid = fraction >= 0.5
        for n in range(self.plate.steps):
            change = layers.step(temperature[n], temperature[n + 1], solid[n + 1], step)
            strain.append(strain[-1] + change)
        return np.array(strain), layers.stress, layers.equivalent


class _Frozen:
    """Stress, flow and hardening of the layers."""

    def __init__(self, layers: Layers) -> None:
        self._volumes, self._metal = layers.volumes, layers.metal
        self._modulus = YOUNG if layers.plane_stress else YOUNG / (1.0 - POISSON)
        self._along = 1.0 if layers.plane_stress else 0.5
        self.stress, self.flow, self.equivalent = np.zeros((3, len(self._volumes)))
        self._strained = np.zeros(len(self._volumes))

    def step(
        self, before: FloatArray, after: FloatArray, solid: BoolArray, seconds: float
    ) -> float:
        """Take a step to other temperatures and return by what ε changes."""
        for kept in (self.stress, self.flow, self.equivalent, self._strained):
            kept[~solid] = 0.0
        self._strained[solid] = np.where(self._strained[solid] > 0.0, 1.0, 0.5)
        if not solid.any():
            return 0.0
        cooled = EXPANSION * SPAN * (after - before)

        def force(change: float) -> float:
            stress = self._returned(change, cooled, after, seconds)[0]
            return float(self._volumes[solid] @ stress[solid])

        change = brentq(force, -0.02, 0.02, xtol=1e-16, rtol=1e-14)
        stress, flow = self._returned(change, cooled, after, seconds)
        self.stress = np.where(solid, stress, 0.0)
        self.flow += np.where(solid, flow, 0.0)
        self.equivalent += np.where(solid, np.abs(flow), 0.0)
        return float(change)

    def _returned(
        self, change: float, cooled: FloatArray, after: FloatArray, seconds: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return stress and change of flow for a change of ε."""
        metal = self._metal
        trial = self.stress + self._modulus * (self._strained * change - cooled)
        beyond = trial - metal.kinematic * self.flow
        excess = np.abs(beyond) - metal.strength(after) - metal.hardening * self.equivalent
        slope = (
            self._modulus * self._along + metal.hardening + metal.kinematic
            + metal.viscosity / seconds
        )  # fmt: skip
        flow = np.sign(beyond) * np.maximum(excess, 0.0) / slope
        return trial - self._modulus * self._along * flow, flow
