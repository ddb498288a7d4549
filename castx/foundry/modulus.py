"""Thermal modulus: volume over cooling surface, read from the time of solidification.

Chvorinov's rule t_s = C M² holds where the heat goes into a mould that is thick against the depth
it warms; sand is, a die is not.
N. Chvorinov, Theorie der Erstarrung von Gussstücken, Die Giesserei 27 (1940) 177-186.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray


@dataclass(frozen=True)
class PouredMetal:
    """The heat that a metal gives up until it is solid.

    Attributes:
        latent_heat: ρL [J/m³].
        heat_capacity: ρc of the liquid [J/m³/K].
        pouring: temperature T_p [°C].
        solidus: T_S [°C].
        liquidus: T_L [°C].
    """

    latent_heat: float
    heat_capacity: float
    pouring: float
    solidus: float
    liquidus: float


@dataclass(frozen=True)
class SandMould:
    """A mould of infinite depth.

    Attributes:
        conductivity: k [W/m/K].
        heat_capacity: ρc [J/m³/K].
        temperature: T_0 at the start [°C].
    """

    conductivity: float
    heat_capacity: float
    temperature: float


def mould_constant(metal: PouredMetal, mould: SandMould) -> float:
    """Return C = (π/4) [(ρL + ρc_l (T_p - T_L))/(T_m - T_0)]²/(k ρc) [s/m²], T_m = (T_L + T_S)/2.

    Of a half-space whose surface takes T_m at once: it draws (T_m - T_0) √(k ρc/(π t)) per area.
    """
    heat = metal.latent_heat + metal.heat_capacity * (metal.pouring - metal.liquidus)
    rise = 0.5 * (metal.solidus + metal.liquidus) - mould.temperature
    return float(0.25 * np.pi * (heat / rise) ** 2 / (mould.conductivity * mould.heat_capacity))


def thermal_modulus(solidification_time: FloatArray, constant: float) -> FloatArray:
    """Return M = √(t_s/C) [m].

    Args:
        solidification_time: t_s, from pouring until all is solid [s].
        constant: C [s/m²].
    """
    return np.asarray(np.sqrt(np.asarray(solidification_time) / constant))
