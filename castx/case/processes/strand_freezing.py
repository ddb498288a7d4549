"""When a strand is solid, by heat alone in a quarter of its section.

Explicit finite volumes over the extents of the section, with as many cells across half its
thickness as give the time to a hundredth. The strand touches its mould all the time, so that it
loses more heat there than behind gaps; then come sprays, and air at last, in which the flux hangs
on the surface: it freezes at last by its thickness, where a shell would grow by roots of time.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.case.processes.plan import AIR
from castx.materials.material import Material
from castx.tables import Table
from castx.transfer.radiation import emission

CELLS = 8
"""Across half the thickness: 12 and 16 give the same times to 0.6 %."""
STABLE = 0.2
"""Fourier number of a step; 0.25 is the limit of explicit ones in two dimensions."""
COOLEST = 600.0
"""Temperature down to which a strand freezes [°C], as far as its diffusivity is asked."""
HALVINGS = 20
"""Of the interval in which the temperature of a surface lies, between cell and surroundings."""


@dataclass(frozen=True)
class StrandCooling:
    """Cooling of the surface of a strand from the meniscus on.

    Attributes:
        mould: coefficient from its surface to the water of the mould [W/m²/K].
        starts: when it leaves the mould, enters further zones of sprays, and comes into air [s].
        sprays: coefficients of the zones over the temperature of the surface [W/m²/K].
        water: temperature of the water [°C].
        emissivity: of its surface in air.
        air: coefficient of still air [W/m²/K].
    """

    mould: float
    starts: Sequence[float]
    sprays: Sequence[Table]
    water: float
    emissivity: float
    air: float

    def flux(self, time: float, surface: FloatArray) -> FloatArray:
        """Return the heat flux at temperatures of the surface [°C], in W/m²."""
        place = bisect_right(self.starts, time)
        if place == 0:
            return self.mould * (surface - self.water)
        if place <= len(self.sprays):
            return self.sprays[place - 1](surface) * (surface - self.water)
        (hot, _), (cold, _) = emission(surface), emission(np.array(AIR))
        radiated = self.emissivity * (hot - cold)
        return np.asarray(radiated + self.air * (surface - AIR))


def solid_after(
    metal: Material, poured: float, extents: Sequence[float], cooling: StrandCooling
) -> float:
    """Return when the core of a strand is solid [s].

    Args:
        metal: of the strand, with its thermal data.
        poured: its temperature at the meniscus [°C].
        extents: of its section [m], shape (2,).
        cooling: of its surface.
    """
    curve = metal.enthalpy
    size = 0.5 * min(extents) / CELLS
    shape = tuple(round(0.5 * extent / size) for extent in extents)
    heat = np.full(shape, float(curve.enthalpy(np.array([poured]))[0]))
    time, step = 0.0, STABLE * size**2 / _largest_diffusivity(metal, poured)
    while (fraction := curve.solid_fraction(heat))[-1, -1] < 1.0:
        temperature = curve.temperature(heat)
        conductivity = metal.conductivity(temperature, fraction)
        for axis in (0, 1):
            t, k, h = (np.moveaxis(f, axis, 0) for f in (temperature, conductivity, heat))
            inwards = 2.0 * k[1:] * k[:-1] / (k[1:] + k[:-1]) * (t[:-1] - t[1:]) / size
            h[1:] += step / size * inwards
            h[:-1] -= step / size * inwards
            h[0] -= step / size * _lost(cooling, time, t[0], 0.5 * size / k[0])
        time += step
    return time


def _lost(
    cooling: StrandCooling, time: float, inside: FloatArray, resistance: FloatArray
) -> FloatArray:
    """Return the flux through a surface behind resistances [m²K/W] to temperatures inside [°C]."""
    low, high = np.full_like(inside, min(cooling.water, AIR)), inside
    for _ in range(HALVINGS):
        surface = 0.5 * (low + high)
        too_hot = surface + resistance * cooling.flux(time, surface) > inside
        low, high = np.where(too_hot, low, surface), np.where(too_hot, surface, high)
    return np.asarray((inside - 0.5 * (low + high)) / resistance)


def _largest_diffusivity(metal: Material, hottest: float) -> float:
    """Return the largest k/(ρ c) on the way to the coolest temperature [m²/s]."""
    temperature = np.linspace(COOLEST, hottest, 100, dtype=np.float64)
    heat = metal.enthalpy.enthalpy(temperature)
    capacity = np.diff(heat) / np.diff(temperature)
    conductivity = metal.conductivity(temperature, metal.solid_fraction_at(temperature))
    return float(conductivity.max() / capacity.min())
