"""Contact methods for parametrised tests, chosen from the registry by what they are."""

from __future__ import annotations

import numpy as np

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


def _carries_nothing_across_a_gap(method: ContactMethod) -> bool:
    if method.pair_law is None:
        return True
    law, one = method.pair_law({key.name: key.default for key in method.keys}), np.ones(1)
    return bool(law.force(1e-9 * one, one, one, 0.0 * one)[0] <= 0.0)


def sharp(methods: tuple[str, ...]) -> tuple[str, ...]:
    """Return the methods by which pairs push only where they touch; others are softened."""
    return tuple(name for name in methods if _carries_nothing_across_a_gap(METHODS[name]))
