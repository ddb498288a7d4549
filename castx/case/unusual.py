"""Warnings of numbers that no casting has: in a mistaken unit, of a mistaken sign or in kelvin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from castx.case.case import Case
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.tables import Table

SUPERHEAT = 300.0
"""Superheat beyond which a pouring temperature may be in kelvin or degrees Fahrenheit [K]."""
WIDEST_GAP = 0.02
"""Initial gap beyond which it may be in millimetres [m]."""


@dataclass(frozen=True)
class UsualRange:
    """Values that materials of castings, moulds and linings have.

    Attributes:
        low: least of the largest value over temperature.
        high: largest of the smallest value over temperature.
        unit: of both.
        mistaken: other units in which numbers are often given, with what they are of `unit`.
    """

    low: float
    high: float
    unit: str
    mistaken: Mapping[str, float]

    def question(self, value: float) -> str:
        """Return whether another unit is meant, in which a value would be usual; or nothing."""
        fitting = (
            name for name, one in self.mistaken.items() if self.low <= value * one <= self.high
        )
        return "".join(f': is "{value:g} {name}" meant?' for name in list(fitting)[:1])


USUAL: Mapping[str, UsualRange] = {
    "density": UsualRange(50.0, 25e3, "kg/m³", {"g/cm^3": 1e3}),
    "heat_capacity": UsualRange(50.0, 2e4, "J/kg/K", {"kJ/kg/K": 1e3}),
    "conductivity": UsualRange(5e-3, 5e3, "W/m/K", {"W/mm/K": 1e3}),
    "latent_heat": UsualRange(5e3, 3e6, "J/kg", {"kJ/kg": 1e3}),
    "young_modulus": UsualRange(1e6, 2e12, "Pa", {"GPa": 1e9, "MPa": 1e6}),
    "expansion": UsualRange(1e-8, 1e-3, "1/K", {"um/m/K": 1e-6}),
    "yield_stress": UsualRange(1e4, 1e10, "Pa", {"MPa": 1e6}),
    "solidification_shrinkage": UsualRange(-0.15, 0.15, "1", {}),
}
MELTING = UsualRange(0.5, 5e3, "W/m/K", {"W/mm/K": 1e3})
"""Conductivities of what melts: metals have more than 5 W/m/K, in W/mm/K less than 0.45; sand or a
ceramic that is given a solidus lies between."""
NEARLY_MELTING = 0.8
"""Share of the solidus in °C from which a body that starts solid may be meant to be poured."""


def unusual(case: Case) -> Iterator[str]:
    """Yield a warning for each number that is far from all that castings have."""
    for name in dict.fromkeys(body.material for body in case.bodies):
        yield from _unusual_values(find_material(name, case.materials))
    yield from _unusual_temperatures(case)
    for interface in case.interfaces:
        widest = float(interface.contact.initial_gap.table.values.max())
        if widest > WIDEST_GAP:
            yield (
                f"interface {interface.name}: initial_gap = {widest:g} m is wider than any gap of "
                f'a casting; plain numbers are in metres: is "{widest:g} mm" meant?'
            )


def _unusual_values(material: Material) -> Iterator[str]:
    for name, usual in USUAL.items():
        kind = "casting or mould"
        if name == "conductivity" and material.melts:
            usual, kind = MELTING, "metal"
        values = _values(getattr(material.description, name))
        if not values or set(values) == {0.0}:  # zero means: none
            continue
        if max(values) < usual.low or min(values) > usual.high:
            shown = max(values) if max(values) < usual.low else min(values)
            yield (
                f"{material.name}: {name} = {shown:g} is far from that of any {kind}, "
                f"{usual.low:g} to {usual.high:g} {usual.unit}; plain numbers are in "
                f"{usual.unit}{usual.question(shown)}"
            )


def _values(given: object) -> list[float]:
    """Return the numbers of a property: of a table, of both phases, or the one that it is."""
    if isinstance(given, Table):
        return [float(value) for value in given.values]
    if isinstance(given, int | float):
        return [float(given)]
    parts = [getattr(given, phase, None) for phase in ("solid", "liquid")]
    return [value for part in parts if isinstance(part, Table) for value in _values(part)]


def _unusual_temperatures(case: Case) -> Iterator[str]:
    """Yield castings that are poured far too hot, and moulds in which none can freeze."""
    solidus, bodies = {}, {body.name: body for body in case.bodies}
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        bounds = body.temperature.bounds
        if material.liquidus is None or bounds is None or body.starts_solid(material.description):
            continue
        solidus[body.name] = material.solidus or material.liquidus
        superheat = bounds[0] - material.liquidus
        if superheat > SUPERHEAT:
            yield (
                f"{body.name} starts at {body.temperature.text}, {superheat:.0f} K above the "
                f"liquidus of {material.name}, {material.liquidus:g} °C; plain numbers are in °C: "
                f'is "{bounds[0]:g} K" or "{bounds[0]:g} degF" meant?'
            )
    yield from _all_solid(case)
    for interface in case.interfaces:
        for casting, other in (interface.bodies, interface.bodies[::-1]):
            bounds = bodies[other].temperature.bounds
            freezes = casting in solidus and other not in solidus
            if freezes and bounds is not None and bounds[0] > solidus[casting]:
                yield (
                    f"{other} starts at {bodies[other].temperature.text}, hotter than "
                    f"{casting} freezes, {solidus[casting]:g} °C: nothing can freeze on it; plain "
                    "numbers are in °C"
                )


def _all_solid(case: Case) -> Iterator[str]:
    """Yield bodies a little below their solidus, of a case in which nothing starts liquid."""
    materials = {body.name: find_material(body.material, case.materials) for body in case.bodies}
    if not all(body.starts_solid(materials[body.name].description) for body in case.bodies):
        return
    for body in case.bodies:
        material, bounds = materials[body.name], body.temperature.bounds
        if bounds is None or material.solidus is None or material.liquidus is None:
            continue
        if NEARLY_MELTING * material.solidus < bounds[1] < material.solidus:
            yield (
                f"{body.name} starts at {body.temperature.text}, below the solidus of "
                f"{material.name}, {material.solidus:g} °C: it is solid from the start, and "
                f"nothing freezes; a casting is poured above its liquidus, {material.liquidus:g} °C"
            )
