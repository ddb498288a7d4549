"""What a process, an alloy and a part make of each other: materials, temperatures and times.

Times are estimates for a first run. A casting of the modulus M = V/A and the mean temperature T,
whose section has the profile of even cooling, a parabola, gives up, per area of its surface,

    q = (T − T_s) 3 k/M = h (T_s − T_m),
    h = 1/(1/closed + g/k_gas) + σ (T_s⁴ − T_m⁴)/((T_s − T_m) E)

by its surface T_s to that of the mould T_m, with E = 1/ε₁ + 1/ε₂ − 1. The gap between them is

    g = −e(T_s) M

with the volumetric strain e of the metal that bears: what it loses by cooling, and by freezing
beyond coherency, is the volume of the gap, e V = −g A, whatever the shape. A plane wall has a third
of that on its faces, and the rest at its rims; the side of a bar has two thirds, a sphere all of
it. The skin counts for the whole section: what it holds is a liquid that freezes and shrinks, which
nothing feeds, and follows it. A thin wall has a small gap so, and iron that swells none. That the
mould grows is left out.

The mould takes the heat in layers of its thickness, across which its area grows evenly to that of
its outside, and loses it there by its coefficient and radiation. One that is thick is Chvorinov's,
t = (π/4) (M ΔH/(b ΔT))² with the effusivity b = √(k ρ c), see `castx.foundry.modulus`. Runs of
sixteen coarse castings in sand, dies and shells froze in 0.8 to 1.6 times the time foretold, and
a plate of zinc 2 mm thick, whose rims have the gap, in 0.56.
In air t = M ρc ln((T − T_a)/(T_cold − T_a))/h.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.case.processes.names import process_names
from castx.case.processes.process import CastingProcess, casting_process
from castx.errors import CaseError
from castx.input.problems import among
from castx.materials.database import database_entry, database_names
from castx.materials.description import MaterialDescription
from castx.materials.granular import GRANULAR
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.thermal_strain import StressFreeState
from castx.transfer.database import interface_entry
from castx.transfer.radiation import facing_factor, radiation_coefficient

COLD = 60.0
"""Temperature at which a casting counts as cold [°C]."""
AIR = 20.0
"""Temperature of the air in which a casting cools at last [°C]."""
POINTS = 2000
"""Temperatures of the table of heat and strain of a casting, from the pouring down."""
LAYERS = 24
"""Of the mould, each `GROWTH` times as thick as the one before it, from the casting outwards."""
GROWTH = 1.25
THICK = 20.0
"""Thickness of a mould of unknown size, in depths to which the heat of freezing would fill it."""
LONGEST = 1e9
"""Time that no casting takes [s]."""
HALVINGS = 30
"""Of the interval in which the temperature of a surface lies."""


@dataclass(frozen=True)
class Plan:
    """Numbers of a first case of a process.

    Attributes:
        process: the process.
        alloy: of the casting.
        mould: material of the mould.
        mould_law: constitutive law of the mould: that of the process, but rigid where it would
            yield as grains and the material has no numbers for that.
        interface: entry of the database of interfaces.
        pouring: temperature of the melt [°C].
        freezing: time until all is solid [s].
        release: when the mould lets go [s].
        end: when the casting is cold [s].
    """

    process: CastingProcess
    alloy: str
    mould: str
    mould_law: str
    interface: str
    pouring: float
    freezing: float
    release: float
    end: float


@dataclass(frozen=True)
class ShellSize:
    """Size of a mould round a casting that is a shell or taken for one.

    Attributes:
        volume: of the mould over the surface of the casting [m].
        outside: its outer surface over that of the casting.
    """

    volume: float
    outside: float


@dataclass(frozen=True)
class ChosenMaterials:
    """Materials of a process, of the database, and what lies between them.

    Attributes:
        process: with the numbers of the class of the alloy.
        alloy: its name.
        metal: its data.
        mould: name of the material of the mould.
        around: its data.
        interface: entry of the database of interfaces.
    """

    process: CastingProcess
    alloy: str
    metal: Material
    mould: str
    around: Material
    interface: str

    @property
    def pouring(self) -> float:
        """Temperature of the melt [°C], rounded to 5 K."""
        assert self.metal.liquidus is not None
        return 5.0 * round((self.metal.liquidus + self.process.numbers["superheat"]) / 5.0)

    @property
    def mould_law(self) -> str:
        """Law of the mould, rigid where it would yield as grains and has no numbers for that."""
        yields = self.process.mould_law != GRANULAR or self.around.description.granular is not None
        return self.process.mould_law if yields else "rigid"

    def mould_fits(self, name: str) -> bool:
        """Return whether a material of the database can be the mould of the process.

        The interface is one with a metal or one with sand or ceramics, and a mould that no water
        cools must not melt.
        """
        usual = self.process.mould
        if name == usual:
            return True
        freezes = find_material(name, {}).solidus
        stays = self.process.is_strand or freezes is None or freezes > self.pouring
        return stays and _kind(name) == (_kind(usual) if usual in database_names() else "mineral")


def chosen(process: CastingProcess, alloy: str | None, mould: str | None) -> ChosenMaterials:
    """Return the materials of a process, arguments and errors as of `plan_of`."""
    alloy, mould = alloy or process.alloy, mould or process.mould
    metal = _known(alloy, "--alloy")
    around = (
        Material(mould, MaterialDescription.read(dict(process.material)))
        if mould == process.mould and process.material
        else _known(mould, "--mould")
    )
    if not metal.melts or metal.liquidus is None or metal.solidus is None:
        raise CaseError(f"--alloy: {alloy} has no latent heat and cannot be cast")
    of_class = database_entry(alloy).material_class
    if of_class not in process.interfaces:
        known = among(of_class, sorted(process.interfaces), what="known classes")
        others = [name for name in process_names() if of_class in casting_process(name).interfaces]
        known = f"{known}; {among('', others, what=f'processes for {of_class}')}"
        raise CaseError(
            f"--alloy: {alloy}: no heat transfer between {of_class} and the mould of "
            f"{process.name} is known; {known}; castx interfaces lists all there are"
        )
    interface = process.interfaces[of_class]
    of = ChosenMaterials(process.of_class(of_class), alloy, metal, mould, around, interface)
    if not of.mould_fits(mould):
        fitting = [name for name in database_names() if of.mould_fits(name)]
        raise CaseError(
            f"--mould: {mould} is no mould of {process.name} for {alloy}, poured at "
            f"{of.pouring:g} °C; {among(mould, fitting)}"
        )
    return of


def plan_of(
    process: CastingProcess,
    alloy: str | None,
    mould: str | None,
    modulus: float,
    shell: ShellSize | None = None,
) -> Plan:
    """Return the numbers of a first case.

    Args:
        process: the process.
        alloy: of the database; None: that of the process.
        mould: material of the database; None: that of the process.
        modulus: volume over surface of the casting [m].
        shell: size of the mould; None: an even shell, or a mould as thick as it may take.

    Raises:
        CaseError: alloy or mould are not in the database, the alloy does not melt, no interface
            of the process is known for it, or the mould is none of the process or would melt.
    """
    of = chosen(process, alloy, mould)
    numbers, solidus = of.process.numbers, of.metal.solidus
    assert solidus is not None
    if shell is None and "shell" in numbers:
        shell = ShellSize(numbers["shell"], 1.0)
    cooling = _Cooling(of, modulus, shell)
    freezing = cooling.time_to(solidus)
    if "release_factor" in numbers:
        hot = 0.8 * solidus
        release = numbers["release_factor"] * freezing
    else:
        hot = numbers["release_temperature"] * solidus
        release = cooling.time_to(hot)
    air = cooling.time_in_air(hot)
    release = rounded(release)
    times = rounded(freezing), release, _together(release, air)
    return Plan(of.process, of.alloy, of.mould, of.mould_law, of.interface, of.pouring, *times)


def rounded(value: float) -> float:
    """Return a number with two digits."""
    return float(f"{value:.2g}")


def _together(release: float, air: float) -> float:
    """Return the sum of a time in the mould and one in air [s], of which two digits are left."""
    step = 10.0 ** (math.floor(math.log10(air)) - 1)
    return round((release + air) / step) * step


def _area(place: FloatArray, outside: float) -> FloatArray:
    """Return the area of a mould at places from 0 to 1, over that of the casting."""
    return 1.0 + (outside - 1.0) * place


def _kind(name: str) -> str:
    of_class = database_entry(name).material_class
    return {"sand": "mineral", "insulation": "mineral", "coating": "coating"}.get(of_class, "metal")


def _known(name: str, option: str) -> Material:
    if name not in database_names():
        raise CaseError(f"{option}: no material {name!r}; {among(name, database_names())}")
    return find_material(name, {})


@dataclass(frozen=True)
class _Casting:
    """A casting over its mean temperature, and the interface round it.

    Attributes:
        given: heat that it has given, rising [J/m² of its surface].
        temperature: falling from the pouring [°C].
        gap: round it with such a surface [m].
        skin: conductance between its mean and its surface, 3 k/M [W/m²/K].
        heat: of the interface, as of the database.
    """

    given: FloatArray
    temperature: FloatArray
    gap: FloatArray
    skin: float
    heat: Mapping[str, Any]

    @classmethod
    def of(cls, of: ChosenMaterials, modulus: float, coldest: float) -> _Casting:
        """Return a casting of a modulus [m] down to its coldest temperature [°C]."""
        metal = of.metal
        assert metal.solidus is not None and metal.description.conductivity is not None
        temperature: FloatArray = np.linspace(of.pouring, coldest, POINTS, dtype=np.float64)
        enthalpy = metal.enthalpy.enthalpy(temperature)
        free = StressFreeState.at_start(metal, of.pouring, of.pouring)
        strain = free.strain(metal, temperature, metal.solid_fraction_at(temperature))
        skin = 3.0 * float(metal.description.conductivity.solid(metal.solidus)) / modulus
        given, gap = modulus * (enthalpy[0] - enthalpy), modulus * np.maximum(-strain, 0.0)
        return cls(given, temperature, gap, skin, interface_entry(of.interface).heat)

    def flux(self, given: float, face: float, inside: float) -> float:
        """Return the flux into the mould [W/m²].

        The colder the surface, the wider its gap: between casting and mould there is one at which
        what comes from within passes on.

        Args:
            given: heat that the casting has given [J/m²].
            face: temperature in the mould [°C].
            inside: resistance from its surface to there [m²K/W].
        """
        mean = float(np.interp(given, self.given, self.temperature))
        low, high = min(mean, face), max(mean, face)
        for _ in range(HALVINGS):
            surface = 0.5 * (low + high)
            passes = (surface - face) / (inside + 1.0 / self._coefficient(surface, face))
            if (mean - surface) * self.skin > passes:
                low = surface
            else:
                high = surface
        return passes

    def _coefficient(self, surface: float, face: float) -> float:
        """Return the coefficient between two surfaces [W/m²/K], as the law `series` has it."""
        gap = np.interp(-surface, -self.temperature, self.gap)
        gas = np.interp(
            0.5 * (surface + face), *np.transpose(self.heat["gas_conductivity"]["table"])
        )
        factor = facing_factor(self.heat["radiation"]["emissivities"])
        conducts = 1.0 / (1.0 / self.heat["closed"] + gap / gas)
        return float(conducts) + factor * radiation_coefficient(surface, face)


@dataclass(frozen=True)
class _Cooling:
    of: ChosenMaterials
    modulus: float
    shell: ShellSize | None

    def time_to(self, temperature: float) -> float:
        """Return when the casting has a mean temperature in its mould [s]."""
        from scipy.integrate import solve_ivp  # runs do without it, and it takes long to import

        numbers = self.of.process.numbers
        start, ambient = numbers["mould_temperature"], numbers["ambient"]
        casting = _Casting.of(self.of, self.modulus, min(temperature, start) - 1.0)
        heat = float(np.interp(-temperature, -casting.temperature, casting.given))
        conductivity, capacity = self._of_mould()
        thickness, outside = self._mould_size(capacity)
        shares = GROWTH ** np.arange(LAYERS)
        edges = thickness * np.concatenate([[0.0], np.cumsum(shares)]) / shares.sum()
        widths, middles = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
        room = capacity * widths * _area(middles / thickness, outside)
        passes = conductivity * _area(edges[1:-1] / thickness, outside) / np.diff(middles)
        halves = 0.5 * widths[[0, -1]] / conductivity

        def rates(_: float, state: FloatArray) -> FloatArray:
            layers, outer = state[1:], float(state[-1])
            emissivity = numbers.get("outside_emissivity", 0.0)
            away = emissivity * radiation_coefficient(outer, ambient)
            away = 1.0 / (halves[1] + 1.0 / (away + numbers["outside_coefficient"]))
            inwards = casting.flux(float(state[0]), float(layers[0]), float(halves[0]))
            leaves = outside * away * (outer - ambient)
            flows = np.concatenate([[inwards], -passes * np.diff(layers), [leaves]])
            return np.concatenate([[inwards], -np.diff(flows) / room])

        def lacks(_: float, state: FloatArray) -> float:
            return float(state[0]) - heat

        lacks.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            rates, (0.0, LONGEST), np.array([0.0, *[start] * LAYERS]), method="BDF", events=lacks,
            rtol=1e-3, atol=np.array([1e-4 * heat, *[0.5] * LAYERS]), first_step=1e-4,
        )  # fmt: skip
        return float(found.t[-1])

    def _mould_size(self, capacity: float) -> tuple[float, float]:
        """Return the thickness of the mould [m], and its outer surface over that of the casting.

        Args:
            capacity: heat capacity of the mould [J/m³/K].
        """
        if self.shell is not None:
            return 2.0 * self.shell.volume / (1.0 + self.shell.outside), self.shell.outside
        poured, solidus = self.of.pouring, self._solidus
        hot, cold = self.of.metal.enthalpy.enthalpy(np.array([poured, solidus]))
        warm = solidus - self.of.process.numbers["mould_temperature"]
        return THICK * self.modulus * float(hot - cold) / (capacity * warm), 1.0

    @property
    def _solidus(self) -> float:
        assert self.of.metal.solidus is not None
        return self.of.metal.solidus

    def _of_mould(self) -> tuple[float, float]:
        """Return conductivity [W/m/K] and heat capacity [J/m³/K] of the mould while it warms."""
        description, cold = self.of.around.description, self.of.process.numbers["mould_temperature"]
        assert description.conductivity is not None
        low, high = self.of.around.enthalpy.enthalpy(np.array([cold, self._solidus]))
        conductivity = float(description.conductivity.solid(0.5 * (cold + self._solidus)))
        return conductivity, float(high - low) / (self._solidus - cold)

    def time_in_air(self, hot: float) -> float:
        """Return the time in which the casting cools in air from a temperature to cold [s]."""
        high, low = self.of.metal.enthalpy.enthalpy(np.array([hot, COLD]))
        capacity = float(high - low) / (hot - COLD)
        decay = math.log((hot - AIR) / (COLD - AIR))
        return self.modulus * capacity / self.of.process.numbers["air_coefficient"] * decay
