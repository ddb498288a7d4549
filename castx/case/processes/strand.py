"""What a continuous casting process makes of a section: speed, times, water, pressure of the pool.

A slice of the strand travels with it, so that its time t is a distance s = v t from the meniscus.
The speed is v = K U/S with K that of the process, U the perimeter and S the area of the section.
The pool presses by P = ρ g R sin(s/R) on a bow of radius R: by the height above. Rolls bear that of
wide strands below the mould, as long as they are not solid. Water takes

    h = 2.83·10⁷ W^0.75 T^-1.2 + 100, in kcal/m²/h/K over W in L/cm²/min and T in °C,

by which sprays were found to cool steel at 700 to 1200 °C: Sasaki and others, Tetsu-to-Hagané 65
(1979) 90, abstract. It was measured with the radiation of the plate, which is not added.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.case.processes.plan import ChosenMaterials, Plan, chosen, rounded
from castx.case.processes.process import ZONES, CastingProcess
from castx.case.processes.strand_freezing import StrandCooling, solid_after
from castx.materials.material import Material
from castx.tables import Table
from castx.transfer.database import interface_entry

GRAVITY = 9.81
"""Of the pressure in the pool [m/s²]."""
SPRAYED = (700.0, 800.0, 900.0, 1000.0, 1100.0, 1200.0)
"""Temperatures of a surface at which the water has been measured [°C]."""
RESERVE = 1.3
"""By how much a first run goes on longer than the strand is estimated to need."""
ROLLED = 1.15
"""By how much longer than it is estimated to need rolls hold a strand: gaps in the mould lengthened
the time of a bloom by 8 %."""
POINTS = 6
"""Of the pressure along the bow."""
_KCAL_PER_HOUR = 4186.8 / 3600.0
_PER_CM2_AND_MINUTE = 60.0 / 1e4


@dataclass(frozen=True)
class StrandSection:
    """The section of a strand.

    Attributes:
        axis: along which it is cast, 0 to 2.
        area: [m²].
        perimeter: [m].
        extents: along the other axes, in their order [m].
    """

    axis: int
    area: float
    perimeter: float
    extents: tuple[float, float]

    @property
    def across(self) -> tuple[int, int]:
        """The other axes."""
        first, second = (axis for axis in range(3) if axis != self.axis)
        return first, second

    @property
    def thickness(self) -> float:
        """The lesser one of the extents [m]."""
        return min(self.extents)

    @property
    def width(self) -> float:
        """The larger one of the extents [m]."""
        return max(self.extents)


@dataclass(frozen=True)
class Zone:
    """A zone of sprays below the mould.

    Attributes:
        name: of the zone.
        start: when the slice enters it [s].
        water: that falls on it [L/m²/s].
        coefficients: of heat transfer at the temperatures `SPRAYED` [W/m²/K].
    """

    name: str
    start: float
    water: float
    coefficients: tuple[float, ...]


@dataclass(frozen=True)
class StrandPlan:
    """Numbers of a first case of a strand.

    Attributes:
        plan: materials and times; `release` is the end of the mould.
        section: that is cast.
        speed: of casting [m/s].
        zones: of sprays.
        air: when the last of them ends [s].
        pressure: of the pool over time, (s, Pa).
        rolls_end: when the last of the rolls that bear it below the mould let go [s]; None: there
            are none.
        taper: by how much each wall has come inwards at the end of the mould, of extents of the
            section.
    """

    plan: Plan
    section: StrandSection
    speed: float
    zones: tuple[Zone, ...]
    air: float
    pressure: tuple[tuple[float, float], ...]
    rolls_end: float | None
    taper: float


def strand_plan_of(
    process: CastingProcess, alloy: str | None, mould: str | None, section: StrandSection
) -> StrandPlan:
    """Return the numbers of a first case of a strand.

    Args:
        process: with `mould_length`.
        alloy: of the database; None: that of the process.
        mould: material of the database; None: that of the process.
        section: that is cast.

    Raises:
        CaseError: alloy or mould are not in the database, the alloy does not melt, or no interface
            of the process is known for it.
    """
    of = chosen(process, alloy, mould)
    numbers = of.process.numbers
    speed = rounded(60.0 * numbers["speed_factor"] * section.perimeter / section.area) / 60.0
    leaves = rounded(numbers["mould_length"] / speed)
    starts = [leaves]
    for name in ZONES:
        starts.append(starts[-1] + rounded(numbers[f"{name}_length"] / speed))
    zones = tuple(
        _zone(name, start, numbers[f"{name}_water"])
        for name, start in zip(ZONES, starts, strict=False)
    )
    cooling = _cooling(of, zones, starts[-1])
    solid = solid_after(of.metal, of.pouring, section.extents, cooling)
    end = rounded(max(RESERVE * solid, 1.1 * starts[-1]))
    rolls = section.width > numbers["rolled_width"]
    radius = numbers["machine_radius"] * section.thickness
    depth = numbers["mould_length"] if rolls else min(speed * end, 0.5 * math.pi * radius)
    pressure = _pressure(of.metal, speed, depth, radius)
    plan = Plan(
        of.process, of.alloy, of.mould, of.mould_law, of.interface, of.pouring, rounded(solid),
        leaves, end,
    )  # fmt: skip
    taper = 0.5 * numbers["taper"] * numbers["mould_length"]
    rolls_end = rounded(max(ROLLED * solid, 1.05 * starts[-1])) if rolls else None
    return StrandPlan(plan, section, speed, zones, starts[-1], pressure, rolls_end, taper)


def _cooling(of: ChosenMaterials, zones: Sequence[Zone], air: float) -> StrandCooling:
    """Return the cooling of a strand that touches its mould all the time.

    Args:
        of: the strand, its mould and what lies between them.
        zones: of sprays.
        air: when the last of them ends [s].
    """
    numbers, heat = of.process.numbers, interface_entry(of.interface).heat
    wall = of.around.conductivity(np.array([numbers["mould_temperature"]]), np.ones(1))
    resistance = numbers["shell"] / float(wall[0]) + 1.0 / numbers["outside_coefficient"]
    return StrandCooling(
        1.0 / (1.0 / float(heat["closed"]) + resistance),
        [*(zone.start for zone in zones), air],
        [Table(np.array(SPRAYED), np.array(zone.coefficients)) for zone in zones],
        numbers["ambient"],
        heat["radiation"]["emissivities"][0],
        numbers["air_coefficient"],
    )


def spray_coefficient(water: float, temperature: float) -> float:
    """Return the coefficient of sprayed water h on hot steel [W/m²/K].

    h = 2.83·10⁷ W^0.75 T^-1.2 + 100, Sasaki and others (1979), see the module.

    Args:
        water: W that falls on the surface [L/m²/s].
        temperature: T of the surface, 700 to 1200 °C.
    """
    flux = _PER_CM2_AND_MINUTE * water
    return float(_KCAL_PER_HOUR * (2.83e7 * flux**0.75 * temperature**-1.2 + 100.0))


def liquid_density(metal: Material) -> float:
    """Return the density of a metal as it begins to freeze [kg/m³].

    ρ (1 − s)/(1 + α ΔT)³ with the mean expansion α up to the solidus and the shrinkage s.
    """
    shrinkage = metal.description.solidification_shrinkage or 0.0
    if metal.expansion is None or metal.solidus is None:
        return metal.density * (1.0 - shrinkage)
    start = metal.expansion_reference if metal.expansion_reference is not None else 20.0
    stretch = 1.0 + float(metal.expansion(metal.solidus)) * (metal.solidus - start)
    return metal.density * (1.0 - shrinkage) / stretch**3


def _zone(name: str, start: float, water: float) -> Zone:
    found = (rounded(spray_coefficient(water, temperature)) for temperature in SPRAYED)
    return Zone(name, start, water, tuple(found))


def _pressure(
    metal: Material, speed: float, depth: float, radius: float
) -> tuple[tuple[float, float], ...]:
    """Return the pressure of the pool over time, from the meniscus to a depth along the strand.

    P = ρ g R sin(s/R), see the module.

    Args:
        metal: of the strand.
        speed: of casting [m/s].
        depth: along the strand [m].
        radius: of its bow [m].
    """
    weight = GRAVITY * liquid_density(metal)
    places = [depth * number / POINTS for number in range(POINTS + 1)]
    return tuple(
        (float(f"{s / speed:.4g}"), float(f"{weight * radius * math.sin(s / radius):.3g}"))
        for s in places
    )
