"""Parts of a mould that touch nothing but the casting, and frames that hold them.

A plug inside an open box hangs on a bridge in the foundry. In a case without gravity and bridge
nothing would keep its place between the walls of the casting. A frame of the stiffness
k = 0.01 E L, with Young's modulus E and L³ the volume of the body, holds it and hinders its growth
by about a hundredth of what fixed surfaces would.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import chain
from typing import TypeVar

from castx.case.processes.plan import rounded
from castx.materials.lookup import find_material
from castx.materials.material import Material

Thing = TypeVar("Thing")

SOFT = 0.01
"""Stiffness of a frame, in units of Young's modulus times the size of the body."""


def held_bodies(
    volumes: Mapping[str, float], touching: Sequence[tuple[str, str]], free: Collection[str]
) -> tuple[str, ...]:
    """Return the bodies that need a frame: loose ones, and the one that is to stay beside them.

    Parts of a mould that touch each other are tied. The heaviest of those that hang together is the
    mould; others are loose, and held where they have a free surface.

    Args:
        volumes: of the bodies that are not cast [m³].
        touching: pairs of bodies that touch each other.
        free: bodies with a surface that no other body shares.
    """
    groups = joined(volumes, [pair for pair in touching if volumes.keys() >= set(pair)])
    groups.sort(key=lambda group: -sum(volumes[name] for name in group))
    holding = [[name for name in group if name in free] for group in groups]
    if len(groups) < 2 or not holding[0] or not any(holding[1:]):
        return ()
    return tuple(max(names, key=lambda name: volumes[name]) for names in holding if names)


def joined(things: Iterable[Thing], links: Iterable[Collection[Thing]]) -> list[list[Thing]]:
    """Return things in groups of what hangs together.

    Args:
        things: all of them, each once.
        links: things that belong together, of `things` alone.
    """
    groups = [[thing] for thing in things]
    for link in links:
        touched = [group for group in groups if any(thing in group for thing in link)]
        groups = [group for group in groups if group not in touched]
        groups.append(list(chain(*touched)))
    return groups


def frame_stiffness(material: Material, temperature: float, volume: float) -> float | None:
    """Return the stiffness of a frame that holds a body [N/m]; None: the material has none.

    Args:
        material: of the body.
        temperature: of the body [°C].
        volume: of the body [m³].
    """
    modulus = material.young_modulus
    if modulus is None:
        return None
    return rounded(SOFT * float(modulus(temperature)) * volume ** (1.0 / 3.0))


def frame_clamp(stiffness: float) -> str:
    """Return the key of a boundary for a frame of a stiffness [N/m]."""
    return f'clamp = {{ stiffness = "{stiffness / 1e6:g} kN/mm", direction = "all" }}'


def frame_text(material: str, temperature: float, volume: float) -> str:
    """Return the line of a boundary that holds a body; nothing for one without a stiffness.

    Args:
        material: of the database.
        temperature: of the body [°C].
        volume: of the body [m³].
    """
    stiffness = frame_stiffness(find_material(material, {}), temperature, volume)
    if stiffness is None:
        return ""
    return f"{frame_clamp(stiffness)}      # hung on a frame: nothing else keeps its place\n"
