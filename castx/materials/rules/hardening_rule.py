"""Declaration of a hardening rule: how the yield surface changes with plastic strain."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol, Self

from castx.arrays import BoolArray, FloatArray
from castx.materials.rules.declaration import check_declaration
from castx.materials.rules.flow_rule import Values
from castx.materials.rules.key import RuleKey
from castx.materials.rules.overstress import Points
from castx.tables import Table


class HardeningCurve(Protocol):
    """Isotropic hardening R(ξ) at points that is not linear; it increases from R(0) = 0."""

    @property
    def curved(self) -> BoolArray:
        """Whether R changes at a point, shape (points,)."""
        ...

    @property
    def steepest(self) -> FloatArray:
        """Largest slope dR/dξ, shape (points,)."""
        ...

    def __call__(self, equivalent: FloatArray) -> FloatArray:
        """Return R(ξ) [Pa], shape (points,)."""
        ...

    def evaluate(self, equivalent: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return R(ξ) [Pa] and ξ dR/dξ, shape (points,)."""
        ...

    def after(self, equivalent: FloatArray) -> Self:
        """Return R(ξ + Δγ) − R(ξ) as a function of Δγ."""
        ...

    def scaled(self, stress: FloatArray, logarithm: FloatArray) -> Self:
        """Return R/stress as a function of ξ/exp(logarithm)."""
        ...

    def at(self, points: Points) -> Self:
        """Return the curve of some of the points."""
        ...


@dataclass(frozen=True, kw_only=True)
class HardeningRule:
    """Growth of the yield stress, or motion of the yield surface, with the plastic strain.

    A file of `castx/materials/hardening` holds one rule as `RULE`, which castx finds by itself.
    All rules whose keys are given act together. Exactly one of `modulus` and `curve` is given.

    Attributes:
        name: of the file.
        title: name for people, "" for a rule that its one key names.
        summary: the rule in one sentence.
        formula: isotropic hardening R(ξ) or back stress β.
        source: author, year, and where the rule is printed.
        keys: that it reads, in `hardening` of a material where the rule is isotropic, else in the
            material itself; given all or none. The rule does not act where the first one is zero.
        example: values of all keys, of an aluminium alloy.
        isotropic: whether it is R(ξ); else it is β = (2/3) modulus e_vp.
        modulus: function of the values of the keys that returns a modulus [Pa], shape (points,).
        curve: function of the values of the keys that returns R(ξ).
    """

    name: str
    title: str
    summary: str
    formula: str
    source: str
    keys: tuple[RuleKey, ...]
    example: Mapping[str, float]
    isotropic: bool
    modulus: Callable[[Values], FloatArray] | None = None
    curve: Callable[[Values], HardeningCurve] | None = None

    def __post_init__(self) -> None:
        check_declaration(self)
        if (self.modulus is None) == (self.curve is None):
            raise TypeError(f"rule {self.name!r} needs modulus or curve, and not both")
        if self.curve is not None and not self.isotropic:
            raise TypeError(f"rule {self.name!r}: a back stress needs a modulus, not a curve")
        if needed := [key.name for key in self.keys if key.default is None]:
            raise TypeError(f"rule {self.name!r} declares no default of {', '.join(needed)}, as 0")
        if len(self.keys) > 1 and not self.title:
            raise TypeError(f"rule {self.name!r} has several keys, and declares no title for them")

    def tables(self, description: object) -> dict[str, Table]:
        """Return the keys of the rule as tables, read from a description that has them."""
        return {key.name: getattr(description, key.name) for key in self.keys}

    def acts(self, description: object) -> bool:
        """Whether the rule acts in a material, read from a description with its keys."""
        return bool(getattr(description, self.keys[0].name).values.any())

    def values(self, description: object, temperature: FloatArray) -> Values:
        """Return the keys at temperatures [°C], read from a description that has them."""
        return {name: table(temperature) for name, table in self.tables(description).items()}
