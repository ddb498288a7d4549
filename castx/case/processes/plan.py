"""What a process, an alloy and a part make of each other: materials, temperatures and times.

Times are estimates for a first run. A casting of the modulus M = V/A gives up the heat ΔH [J/m³]
down to a temperature in

    t = f M ΔH/(h ΔT) + (π/4) (M ΔH/(b ΔT))²

with the coefficient h at its surface, the effusivity b = √(k ρ c) of the mould, and the mean
difference ΔT between casting and mould; f = 2 since a gap opens. The first term is that of an
interface, the second Chvorinov's, see `castx.foundry.modulus`. Through a shell and its outside goes

    q = (T − T_a)/(f/h + d ln a/((a − 1) k) + 1/(a h_o)), h_o = h_a + ε σ (T_o⁴ − T_a⁴)/(T_o − T_a)

per area of the casting, with the thickness d of the shell and the temperature T_o of its outside,
a times as large as the inside, as round a cylinder; t is the sum of dE/q, where E has the heat
that the casting has given and what the shell has, whose temperature falls evenly outwards.
In air t = M ρc ln((T − T_a)/(T_cold − T_a))/h.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from castx.case.processes.names import process_names
from castx.case.processes.process import CastingProcess, casting_process
from castx.errors import CaseError
from castx.input.problems import among
from castx.input.units import ABSOLUTE_ZERO
from castx.materials.database import database_entry, database_names
from castx.materials.description import MaterialDescription
from castx.materials.granular import GRANULAR
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.transfer.database import interface_entry
from castx.transfer.radiation import STEFAN_BOLTZMANN

COLD = 60.0
"""Temperature at which a casting counts as cold [°C]."""
AIR = 20.0
"""Temperature of the air in which a casting cools at last [°C]."""
POINTS = 100
"""At which the flux through a shell is found, from the pouring down."""
GAP_FACTOR = 2.0
"""By how much an air gap lengthens what a touching interface would take."""


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
        shell: of a process with one; None: an even one.

    Raises:
        CaseError: alloy or mould are not in the database, the alloy does not melt, no interface
            of the process is known for it, or the mould is none of the process or would melt.
    """
    of = chosen(process, alloy, mould)
    numbers, solidus = of.process.numbers, of.metal.solidus
    assert solidus is not None
    if shell is None:
        shell = ShellSize(numbers.get("shell", 0.0), 1.0)
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


def _kind(name: str) -> str:
    of_class = database_entry(name).material_class
    return {"sand": "mineral", "insulation": "mineral", "coating": "coating"}.get(of_class, "metal")


def _known(name: str, option: str) -> Material:
    if name not in database_names():
        raise CaseError(f"{option}: no material {name!r}; {among(name, database_names())}")
    return find_material(name, {})


@dataclass(frozen=True)
class _Cooling:
    of: ChosenMaterials
    modulus: float
    shell: ShellSize

    def _heat(self, temperature: float) -> float:
        """Return the heat per volume from the pouring down to a temperature [J/m³]."""
        hot, cold = self.of.metal.enthalpy.enthalpy(np.array([self.of.pouring, temperature]))
        return float(hot - cold)

    def time_to(self, temperature: float) -> float:
        """Return when the casting has a temperature in its mould [s]."""
        numbers = self.of.process.numbers
        heat = self.modulus * self._heat(temperature)
        mean = 0.5 * ((self.of.metal.liquidus or self.of.pouring) + temperature)
        closed = float(interface_entry(self.of.interface).heat["closed"])
        if "shell" in numbers:
            return self._through_shell(temperature, GAP_FACTOR / closed)
        warm = mean - numbers["mould_temperature"]
        conductivity, capacity = self._of_mould(numbers["mould_temperature"])
        through = GAP_FACTOR * heat / (closed * warm)
        return through + 0.25 * math.pi * (heat / warm) ** 2 / (conductivity * capacity)

    def _through_shell(self, temperature: float, face: float) -> float:
        """Return when the casting has a temperature in its shell [s].

        Args:
            temperature: [°C].
            face: resistance between casting and shell [m²K/W].
        """
        numbers, poured = self.of.process.numbers, self.of.pouring
        conductivity, capacity = self._of_mould(numbers["mould_temperature"])
        wider = self.shell.outside - 1.0
        curved = math.log1p(wider) / wider if wider else 1.0
        inside = face + curved * numbers["shell"] / conductivity
        steps = np.linspace(poured, temperature, POINTS)
        heat = self.modulus * np.array([self._heat(float(at)) for at in steps])
        flux = np.array([self._flux(float(at), inside) for at in steps])
        outwards = (1.0 + 2.0 * self.shell.outside) / (3.0 + 3.0 * self.shell.outside)
        middle = steps - flux * (face + outwards * (inside - face))
        heat += self.shell.volume * capacity * (numbers["mould_temperature"] - middle)
        # The shell takes heat at first: until the casting has given that, nothing has left both.
        left = np.maximum.accumulate(np.maximum(heat, 0.0))
        slow = 1.0 / flux
        return float(left[0] * slow[0] + np.sum(np.diff(left) * 0.5 * (slow[1:] + slow[:-1])))

    def _flux(self, temperature: float, inside: float) -> float:
        """Return the flux per area of a casting through its shell to the outside [W/m²]."""
        from scipy.optimize import brentq  # runs do without it, and it takes long to import

        numbers, surface = self.of.process.numbers, self.shell.outside
        ambient = numbers["ambient"]

        def excess(outer: float) -> float:
            away = numbers["outside_coefficient"] * (outer - ambient)
            fourth = (outer - ABSOLUTE_ZERO) ** 4 - (ambient - ABSOLUTE_ZERO) ** 4
            away += numbers.get("outside_emissivity", 0.0) * STEFAN_BOLTZMANN * fourth
            return surface * away - (temperature - outer) / inside

        outer = float(brentq(excess, ambient, temperature))
        return (temperature - outer) / inside

    def _of_mould(self, temperature: float) -> tuple[float, float]:
        """Return conductivity [W/m/K] and heat capacity [J/m³/K] of the mould."""
        description = self.of.around.description
        assert description.conductivity is not None
        low, high = self.of.around.enthalpy.enthalpy(np.array([temperature, temperature + 50.0]))
        return float(description.conductivity.solid(temperature)), float(high - low) / 50.0

    def time_in_air(self, hot: float) -> float:
        """Return the time in which the casting cools in air from a temperature to cold [s]."""
        high, low = self.of.metal.enthalpy.enthalpy(np.array([hot, COLD]))
        capacity = float(high - low) / (hot - COLD)
        decay = math.log((hot - AIR) / (COLD - AIR))
        return self.modulus * capacity / self.of.process.numbers["air_coefficient"] * decay
