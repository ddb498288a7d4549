"""Contact methods chosen by the interfaces, and their combinations."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from castx.arrays import FloatArray
from castx.case.contact import BY_NODES, Pairing, body_problem, friction_problem, is_tied
from castx.contact.kinematics.rows import Treatment
from castx.contact.methods.description import ContactMethod, Setting, Settings, UnknownKind
from castx.contact.methods.exponential import CLEARANCE
from castx.contact.methods.registry import DEFAULT, METHODS, keys, setting
from castx.errors import CaseError

TREATMENTS = {
    UnknownKind.GAPS: Treatment.CONDENSED,
    UnknownKind.MULTIPLIERS: Treatment.UNCHANGED,
    UnknownKind.DISPLACEMENTS: Treatment.UNCHANGED,
    UnknownKind.TIED: Treatment.TIED,
}
"""What the change of unknowns makes of the pairs."""


@dataclass(frozen=True)
class Contact:
    """Contact on an interface.

    Attributes:
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body; one without unknowns is rigid.
        method: a name of `castx.contact.methods.registry.METHODS`.
        initial_gap: gap without displacement at points (n, dimension) [m], negative: interference.
        settings: values of keys of the method; one that is left out has its default.
        fallback: methods that take over for a step in which the one before has failed.
        pairing: how nodes find partners and normals.
        friction: Coulomb's coefficient μ.
    """

    secondary: str
    primary: str
    method: str = DEFAULT
    initial_gap: Callable[[FloatArray], FloatArray] = lambda points: np.zeros(len(points))
    settings: Settings = field(default_factory=dict)
    fallback: tuple[str, ...] = ()
    pairing: Pairing = BY_NODES
    friction: float = 0.0

    @property
    def name(self) -> str:
        """Name of the interface as "secondary/primary"."""
        return f"{self.secondary}/{self.primary}"

    @property
    def surfaces(self) -> tuple[str, str]:
        """Names of the surfaces of the secondary and of the primary body."""
        return self.pairing.surfaces or (self.primary, self.secondary)

    @property
    def treatment(self) -> Treatment:
        """Treatment of the pairs by the change of unknowns."""
        treatment = TREATMENTS[METHODS[self.method].unknowns]
        slides = self.friction > 0 and treatment is Treatment.CONDENSED
        return Treatment.SLIDING if slides else treatment

    @property
    def clearance(self) -> float:
        """Gap from which the surfaces touch [m]: zero unless the method softens them."""
        softens = METHODS[self.method].uses(CLEARANCE.name)
        return float(self.setting(CLEARANCE.name)) if softens else 0.0

    def setting(self, key: str) -> Setting:
        """Return the value of a key of the method."""
        return setting(self.settings, key)


def common_method(contacts: Sequence[Contact]) -> ContactMethod:
    """Return the method of all interfaces; tied ones go with any, rigid ones with condensed.

    Raises:
        CaseError: methods, or numbers that belong to a method, differ.
    """
    methods = {METHODS[c.method].solved_as or c.method for c in contacts if not is_tied(c.method)}
    if len(methods) > 1:
        raise CaseError(
            f"contact methods {', '.join(sorted(methods))} in one case; use the same for all "
            "interfaces (tied ones may differ)"
        )
    for key in (key.name for key in keys().values() if key.common):
        values = {c.setting(key) for c in contacts if c.method in methods}
        if len(values) > 1:
            found = ", ".join(str(value) for value in sorted(values, key=str))
            raise CaseError(f"contact.{key} {found} in one case; use the same for all interfaces")
    return METHODS[next(iter(methods), DEFAULT)]


def fallbacks(contacts: Sequence[Contact]) -> list[tuple[str, list[Contact]]]:
    """Return the methods that take over one after the other, and the interfaces with them.

    Raises:
        CaseError: the interfaces name different ones.
    """
    named = {c.fallback for c in contacts if METHODS[c.method].fallback}
    if len(named) > 1:
        found = " and ".join(str(list(names)) for names in sorted(named))
        raise CaseError(f"contact.fallback {found} in one case; use the same for all interfaces")
    methods = next(iter(named), ())
    return [
        (name, [c if is_tied(c.method) else replace(c, method=name) for c in contacts])
        for name in methods
    ]


def check_bodies(contacts: Sequence[Contact], deformable: Collection[str]) -> None:
    """Refuse interfaces between bodies that cannot touch the way they should.

    Raises:
        CaseError: a rigid secondary body, or contact that needs a rigid primary one without it.
    """
    for contact in contacts:
        rigid = {contact.secondary, contact.primary} - set(deformable)
        problem = body_problem(contact.method, contact.secondary, contact.primary, rigid)
        problem = problem or friction_problem(
            (contact.method, *contact.fallback), contact.pairing, contact.friction
        )
        if problem:
            raise CaseError(f"interface {contact.name}: {problem}")
