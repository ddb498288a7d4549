"""Declaration of a contact method, and the law of a pair."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from castx.arrays import FloatArray

Setting = float | str
"""Value of a key of the case file."""

Settings = Mapping[str, Setting]
"""Values of keys by name."""


class UnknownKind(Enum):
    """Kind of unknowns that carry the contact of a pair.

    GAPS: the gap of each pair is an unknown in place of a motion of its secondary node.
    MULTIPLIERS: a pressure for each pair is one more unknown.
    DISPLACEMENTS: nothing; the force of a pair is a function of its gap, its pair law.
    TIED: all relative motions of a pair are unknowns, fixed at zero.
    """

    GAPS = "gaps"
    MULTIPLIERS = "multipliers"
    DISPLACEMENTS = "displacements"
    TIED = "tied"


class PairLaw(Protocol):
    """Normal force of pairs as a function of their gaps, one value for each pair.

    Attributes:
        is_linear: whether the slope is the same at every gap.
    """

    is_linear: bool

    def force(
        self, gaps: FloatArray, areas: FloatArray, stiffness: FloatArray, multipliers: FloatArray
    ) -> FloatArray:
        """Return the forces [N], compressive positive; a pair with a negative one opens.

        Args:
            gaps: g [m], negative where pairs penetrate.
            areas: S [m²].
            stiffness: ε S [N/m].
            multipliers: λ S [N].
        """

    def slope(
        self, gaps: FloatArray, areas: FloatArray, stiffness: FloatArray, multipliers: FloatArray
    ) -> FloatArray:
        """Return -∂f/∂g [N/m], for the arguments of `force`."""


class KeyKind(Protocol):
    """Kind of the values of a key."""

    def read(self, value: Any) -> Any:
        """Return the value as the case keeps it.

        Raises:
            CaseError: not a value of this kind.
        """


@dataclass(frozen=True)
class Key:
    """A key of `contact` in the case file that belongs to methods.

    Attributes:
        name: of the key.
        kind: what its values are.
        default: value of a key that is left out.
        summary: what it says, one sentence.
        common: whether all interfaces of a case need the same value.
    """

    name: str
    kind: KeyKind
    default: Setting
    summary: str
    common: bool = True


@dataclass(frozen=True)
class ContactMethod:
    """A contact method as a case asks for it.

    Attributes:
        name: word of the case file; the name of its file with "-" for "_".
        summary: what it does, one sentence.
        formula: its equations as text.
        source: where they stand: paper, section, equation.
        advice: when to use it.
        unknowns: what carries the contact among the unknowns.
        computed_by: full name of the class in which its equations stand.
        keys: keys of the case file that it uses.
        pair_law: makes the law of the pairs of an interface from the values of all keys of the
            method; for forces that are a function of the gap.
        exact: whether closed pairs do not penetrate.
        friction: whether it has friction.
        fallback: whether it may take over from another method, and another one from it.
        rigid_primary: whether it needs a rigid primary body.
        solved_as: method that interfaces of this one share their equations with; "": itself.
        by_blocks: whether the bodies are solved one after the other.
        updates_multipliers: whether multipliers that are no unknowns improve between iterations.
    """

    name: str
    summary: str
    formula: str
    source: str
    advice: str
    unknowns: UnknownKind
    computed_by: str = "castx.contact.soft.SoftContact"
    keys: tuple[Key, ...] = ()
    pair_law: Callable[[Settings], PairLaw] | None = None
    exact: bool = False
    friction: bool = False
    fallback: bool = True
    rigid_primary: bool = False
    solved_as: str = ""
    by_blocks: bool = False
    updates_multipliers: bool = False

    def uses(self, key: str) -> bool:
        """Return whether the method uses a key of the case file."""
        return key in [own.name for own in self.keys]
