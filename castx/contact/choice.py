"""What an interface asks of its contact, and which methods go together."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from castx.arrays import FloatArray
from castx.case.pairing import BY_NODES, Pairing
from castx.contact.kinematics.rows import Treatment
from castx.errors import CaseError

TREATMENTS = {
    "condensed": Treatment.CONDENSED,
    "rigid": Treatment.CONDENSED,
    "tied": Treatment.TIED,
    "multipliers": Treatment.READ,
    "penalty": Treatment.READ,
    "augmented-lagrangian": Treatment.READ,
    "block-iterative": Treatment.READ,
}
"""What the coordinates make of the pairs, by method."""


COMMON_NUMBERS = (
    "augmentation",
    "augmentations",
    "blocks",
    "block_solver",
    "block_iterations",
)
"""What belongs to a method, not to an interface."""


@dataclass(frozen=True)
class Contact:
    """Contact on an interface.

    Attributes:
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body; one without unknowns is rigid.
        method: a name of `TREATMENTS`.
        initial_gap: gap without displacement at points (n, dimension) [m], negative: interference.
        penalty: ε [Pa/m] of the methods that have one; None: by the stiffness of the softer side.
        augmentation: "iteration" updates multipliers after every Newton iteration, "loop" after
            those that balance.
        augmentations: updates in one solve, at most.
        blocks: of the block-iterative method: "bodies", or "interface" for the interiors of the
            bodies and then all nodes of interfaces.
        block_solver: "iteration" sweeps over the blocks, "preconditioner" lets a Krylov method do.
        block_iterations: sweeps of one solve, at most.
        fallback: methods that take over for a step in which the one before has failed.
        pairing: how nodes find partners and normals.
        friction: Coulomb's coefficient μ.
    """

    secondary: str
    primary: str
    method: str = "condensed"
    initial_gap: Callable[[FloatArray], FloatArray] = lambda points: np.zeros(len(points))
    penalty: float | None = None
    augmentation: str = "loop"
    augmentations: int = 30
    blocks: str = "bodies"
    block_solver: str = "iteration"
    block_iterations: int = 50
    fallback: tuple[str, ...] = ()
    pairing: Pairing = BY_NODES
    friction: float = 0.0

    @property
    def name(self) -> str:
        """Name of the interface as "secondary/primary"."""
        return f"{self.secondary}/{self.primary}"

    @property
    def treatment(self) -> Treatment:
        """What the coordinates make of the pairs."""
        treatment = TREATMENTS[self.method]
        slides = self.friction > 0 and treatment is Treatment.CONDENSED
        return Treatment.SLIDING if slides else treatment


WITH_FRICTION = ("condensed", "rigid", "penalty")
"""Methods that know friction."""


def friction_problem(methods: Collection[str], pairing: Pairing, friction: float) -> str:
    """Return what keeps an interface from having friction; or nothing."""
    without = sorted(set(methods) - set(WITH_FRICTION))
    if friction == 0:
        return ""
    if without:
        return f"method {without[0]!r} has no friction; those that have: {', '.join(WITH_FRICTION)}"
    if len(methods) > 1:
        return "what has slipped is known to one method alone; leave fallback out"
    if pairing.kind != "node-to-node" or pairing.normals == "patches":
        return 'friction needs pairing = "node-to-node" and one normal for each node, "averaged"'
    return ""


def common_method(contacts: Sequence[Contact]) -> str:
    """Return the method of all interfaces; tied ones go with any, rigid ones with condensed.

    Raises:
        CaseError: methods, or numbers that belong to a method, differ.
    """
    methods = {"condensed" if c.method == "rigid" else c.method for c in contacts} - {"tied"}
    if len(methods) > 1:
        raise CaseError(
            f"contact methods {', '.join(sorted(methods))} in one case; use the same for all "
            "interfaces (tied ones may differ)"
        )
    for name in COMMON_NUMBERS:
        values = {getattr(c, name) for c in contacts if c.method in methods}
        if len(values) > 1:
            found = ", ".join(str(value) for value in sorted(values))
            raise CaseError(f"contact.{name} {found} in one case; use the same for all interfaces")
    return next(iter(methods), "condensed")


def fallbacks(contacts: Sequence[Contact]) -> list[tuple[str, list[Contact]]]:
    """Return the methods that take over one after the other, and the interfaces with them.

    Raises:
        CaseError: the interfaces name different ones.
    """
    named = {c.fallback for c in contacts if c.method not in ("tied", "rigid")}
    if len(named) > 1:
        found = " and ".join(str(list(names)) for names in sorted(named))
        raise CaseError(f"contact.fallback {found} in one case; use the same for all interfaces")
    methods = next(iter(named), ())
    return [
        (name, [c if c.method == "tied" else replace(c, method=name) for c in contacts])
        for name in methods
    ]


def body_problem(method: str, secondary: str, primary: str, rigid: Collection[str]) -> str:
    """Return what is wrong with contact between two bodies, of which some are rigid; or nothing."""
    if secondary in rigid and primary in rigid:
        return 'both bodies are rigid; use method = "none"'
    if secondary in rigid:
        return (
            f"the secondary body {secondary!r} is rigid; name the bodies the other way round: "
            f'["{primary}", "{secondary}"]'
        )
    if method == "rigid" and primary not in rigid:
        return (
            f'needs a rigid primary body; give {primary!r} law = "rigid", or use another method '
            'such as "condensed"'
        )
    return ""


def check_bodies(contacts: Sequence[Contact], deformable: Collection[str]) -> None:
    """Refuse interfaces between bodies that cannot touch the way they should.

    Raises:
        CaseError: a rigid secondary body, or contact of method "rigid" with a deformable one.
    """
    for contact in contacts:
        rigid = {contact.secondary, contact.primary} - set(deformable)
        problem = body_problem(contact.method, contact.secondary, contact.primary, rigid)
        problem = problem or friction_problem(
            (contact.method, *contact.fallback), contact.pairing, contact.friction
        )
        if problem:
            raise CaseError(f"interface {contact.name}: {problem}")
