"""A first case file for a CAD part that is cast by a known process."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from castx.case.cad.holds import frame_text
from castx.case.cad.template import CASTING, CHILL, MOULD, PLUG, SAND, NewCase, geometry_text
from castx.case.processes.plan import AIR, Plan
from castx.case.processes.process import CastingProcess
from castx.input.units import plain_text
from castx.materials.granular import GRANULAR
from castx.materials.lookup import find_material
from castx.transfer.database import interface_entry

CORES = {
    "aluminium": "aluminium-core-sand", "cast iron": "iron-sand-coated",
    "steel": "steel-sand-coated", "copper": "bronze-sand",
}  # fmt: skip
"""Interfaces between a casting and sand, by class of alloy."""
OPEN_COEFFICIENT = 10.0
"""Of still air over an open top, beside its radiation [W/m²/K]."""
CHILLS = {
    "aluminium": ("Cu-pure", "aluminium-chill-copper"),
    "cast iron": ("steel-carbon", "iron-chill-iron"),
}
"""Material of chills and their interface with the casting, by class of alloy."""
DIE_PARTS = 'heat = { law = "constant", closed = 3000 }     # usual: ground faces, clamped\n'
BETWEEN_SAND = 'heat = { law = "constant", closed = 500 }     # usual: cope on drag, a core\n'


def process_text(case: NewCase, plan: Plan, of_class: str) -> str:
    """Return the case file of a part that is cast by a process.

    Args:
        case: properties of the part, with bodies, interfaces and surfaces of its mould.
        plan: alloy, mould, temperatures and times.
        of_class: of the alloy.
    """
    role = case.roles
    parts = [process_head(plan.process), geometry_text(case), *_own_material(plan)]
    tight = _swells_shut(case, role, plan)
    parts += [_body(name, v, role[name], plan, of_class, tight) for name, v in case.bodies]
    parts += [_interface(pair, role, plan, of_class) for pair in case.interfaces]
    held = _frames(case, role, plan, of_class)
    parts += [
        _boundary(on, area, role, plan) + held.get(on.partition("/")[0], "")
        for on, area in case.surfaces
    ]
    parts += _stages(role, plan)
    parts.append(
        f'[time]\nend = "{plan.end:g} s"                   # until the casting is cold, by estimate'
        "\n"
    )
    return "\n".join(parts)


def process_head(process: CastingProcess, *said: str) -> str:
    """Return the comment at the top of a case: its process, what is said of it, its numbers."""
    lines = [
        f"# {process.name}: {process.summary}.",
        *said,
        "# Numbers of the process are usual ones, those below; interfaces and materials are of the",
        "# databases, with their sources. Change what you know better. Lengths are in metres,",
        "# temperatures in °C, or carry a unit. Then: castx check, castx run, castx report.",
    ]
    lines += [
        f"#   {key} = {process.numbers[key]:g}: {_unmarked(text)}"
        for key, text in process.sources.items()
    ]
    return "\n".join(lines) + "\n"


def _unmarked(source: str) -> str:
    """Return a source without what is said of all of them at the top of a case."""
    return source.removeprefix("usual: ").removesuffix(
        "; representative value, source not established"
    )


def _own_material(plan: Plan) -> Iterator[str]:
    if plan.process.material and plan.mould == plan.process.mould:
        rows = "".join(f"{key} = {value:g}\n" for key, value in plan.process.material.items())
        yield f"[materials.{plan.mould}]        # representative, sources not established\n{rows}"


def _swells_shut(case: NewCase, role: Mapping[str, int], plan: Plan) -> bool:
    """Return whether the alloy swells as it freezes, without a surface at which it may."""
    shrinkage = find_material(plan.alloy, {}).description.solidification_shrinkage
    free = any(role.get(on.partition("/")[0]) == CASTING for on, _ in case.surfaces)
    return (shrinkage or 0.0) < 0.0 and not free


def _made_of(role: int, plan: Plan, of_class: str) -> tuple[str, float, str]:
    """Return material, temperature at the start [°C] and law of a body by its role."""
    chill = CHILLS.get(of_class, ("Cu-pure", ""))[0]
    return {
        CASTING: (plan.alloy, plan.pouring, "thermo-elasto-viscoplastic"),
        CHILL: (chill, 20.0, "thermo-elastic"),
        MOULD: (plan.mould, plan.process.numbers["mould_temperature"], plan.mould_law),
        SAND: ("sand-silica", 20.0, GRANULAR),
    }[role]


def _body(name: str, volume: float, role: int, plan: Plan, of_class: str, tight: bool) -> str:
    material, temperature, law = _made_of(role, plan, of_class)
    return (
        f'[[bodies]]                      # {plain_text(1e6 * volume)} cm³\nname = "{name}"\n'
        f'material = "{material}"\ntemperature = {temperature:g}\n'
        f'law = "{law}"{_told(law, tight)}\n'
    )


def _frames(case: NewCase, role: Mapping[str, int], plan: Plan, of_class: str) -> dict[str, str]:
    """Return the conditions that hold bodies on frames; rigid ones stay without."""
    volumes = dict(case.bodies)
    made = {name: _made_of(role[name], plan, of_class) for name in case.held}
    return {
        name: frame_text(material, temperature, volumes[name])
        for name, (material, temperature, law) in made.items()
        if law != "rigid"
    }


def _told(law: str, tight: bool) -> str:
    """Return the comment beside a law: what sand does, and what takes less time.

    Args:
        law: of a body.
        tight: whether the alloy swells in walls on all sides.
    """
    if law != GRANULAR:
        return ""
    if tight:
        return "         # sand that yields; in a rigid mould iron has no room to swell"
    return '         # sand that yields; "rigid" holds it, in half of the time or less'


def _interface(
    pair: tuple[str, str, float], role: Mapping[str, int], plan: Plan, of_class: str
) -> str:
    # A mould stands second, where it may be rigid.
    first, second = sorted(pair[:2], key=lambda name: (role[name] == MOULD, role[name]))
    area = f"# {plain_text(1e4 * pair[2])} cm²"
    head = f'[[interfaces]]                  {area}\nbodies = ["{first}", "{second}"]\n'
    if role[first] == CASTING and role[second] == CASTING:
        return head + 'contact = { method = "tied" }\n'
    if role[first] == CASTING:
        entry = {
            MOULD: plan.interface,
            SAND: CORES.get(of_class, plan.interface),
            CHILL: CHILLS.get(of_class, ("", plan.interface))[1],
        }[role[second]]
        return head + f'heat = {{ from = "{entry}" }}     # castx interfaces {entry}\n'
    kinds = role[first], role[second]
    # Rigid moulds cannot be tied; other halves are clamped, and prints hold a core.
    loose = plan.mould_law == "rigid" and MOULD in kinds
    contact = 'contact = { method = "none" }\n' if loose else 'contact = { method = "tied" }\n'
    soft = plan.mould_law in ("rigid", GRANULAR) or SAND in kinds
    return head + contact + (BETWEEN_SAND if soft else DIE_PARTS)


def _boundary(on: str, area: float, role: Mapping[str, int], plan: Plan) -> str:
    numbers = plan.process.numbers
    begin = f'[[boundaries]]                  # {plain_text(1e4 * area)} cm²\non = "{on}"\n'
    if role.get(on.partition("/")[0]) == CASTING:
        rows = listed(bare_metal(plan.interface, OPEN_COEFFICIENT))
        return f"{begin}heat = [                        # open top\n{rows}]\n"
    outside, ambient = outside_heat(numbers), numbers["ambient"]
    if "outside_emissivity" not in numbers:
        return f"{begin}heat = {outside}\n"
    rows = listed([radiation(numbers["outside_emissivity"], ambient), outside])
    return f"{begin}heat = [\n{rows}]\n"


def outside_heat(numbers: Mapping[str, float]) -> str:
    """Return the condition at the outside of a mould, by the numbers of a process."""
    return convection(numbers["outside_coefficient"], numbers["ambient"])


def bare_metal(interface: str, coefficient: float) -> list[str]:
    """Return the conditions of metal in air, whose emissivity an interface of it tells.

    Args:
        interface: entry of the database.
        coefficient: of the air [W/m²/K].
    """
    emissivity = interface_entry(interface).heat["radiation"]["emissivities"][0]
    return [radiation(emissivity, AIR), convection(coefficient, AIR)]


def convection(coefficient: float, ambient: float) -> str:
    """Return a condition by a coefficient [W/m²/K] and a temperature [°C]."""
    return f'{{ type = "convection", coefficient = {coefficient:g}, ambient = {ambient:g} }}'


def radiation(emissivity: float, ambient: float) -> str:
    """Return a condition by an emissivity and a temperature [°C]."""
    return f'{{ type = "radiation", emissivity = {emissivity:g}, ambient = {ambient:g} }}'


def listed(conditions: Sequence[str]) -> str:
    """Return conditions as the rows of a list."""
    return "".join(f"    {condition},\n" for condition in conditions)


def _stages(role: Mapping[str, int], plan: Plan) -> Iterator[str]:
    """Yield the stages in which the mould lets go of the casting, which then cools in air."""
    around = [name for name, kind in role.items() if kind != CASTING]
    moving = [name for name in around if name.endswith("-high") or name == PLUG]
    delay = plan.process.numbers.get("ejection_delay")
    at, air = plan.release, plan.process.numbers["air_coefficient"]
    if delay is not None and moving:
        yield _stage(at, moving, air, "the die opens")
        at, around = at + delay, [name for name in around if name not in moving]
        yield _stage(at, around, air, "the casting is ejected")
        return
    yield _stage(at, around, air, f"the mould {plan.process.release}")


def _stage(at: float, bodies: Sequence[str], air: float, what: str) -> str:
    names = ", ".join(f'"{name}"' for name in bodies)
    return (
        f'[[stages]]                      # {what}\nat = "{at:g} s"\nremove = [{names}]\n'
        f"spray = {{ coefficient = {air:g}, ambient = 20 }}     # air on what is left bare\n"
    )
