"""Contact methods for parametrised tests, chosen from the registry by what they are."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, UnknownKind
from castx.contact.methods.registry import METHODS, names


def _for_deformable_bodies(method: ContactMethod) -> bool:
    return method.fallback and not method.rigid_primary


TWO_BODIES = names(_for_deformable_bodies)
"""Methods that let two deformable bodies part."""

AT_ONCE = names(lambda method: _for_deformable_bodies(method) and not method.by_blocks)
"""Those that solve for all bodies at once."""

EXACT = names(lambda method: _for_deformable_bodies(method) and method.exact)
"""Those by which no pair penetrates."""

FORCE_OF_GAP = names(lambda method: method.unknowns is UnknownKind.DISPLACEMENTS)
"""Those in which the force of a pair is a function of its gap."""

WITH_FRICTION = tuple(name for name in AT_ONCE if METHODS[name].friction)
"""Those with friction."""

IN_THE_LIMIT = tuple(n for n in AT_ONCE if METHODS[n].exact or METHODS[n].updates_multipliers)
"""Those that end without penetration."""

WITH_RIGID_BODIES = names(
    lambda method: method.unknowns is not UnknownKind.TIED and not method.by_blocks
)
"""Those that let a body part from a rigid one, all bodies at once."""

BETWEEN_DEFORMABLE = names(lambda method: not method.rigid_primary)
"""Those between two deformable bodies, tied ones included."""
