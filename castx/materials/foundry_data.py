"""Arm spacing, strength by it, and fatigue, as keys of a material in a case file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from castx.errors import CaseError
from castx.input.entries import Description, Quantity
from castx.input.units import LENGTH, PURE_NUMBER, STRESS, Dimension
from castx.materials.rules.key import PlainQuantity

RIPENING = 1.0 / 3.0
"""Exponent of arms that coarsen by diffusion in the melt."""


SPACING_COEFFICIENT = Dimension("an arm spacing at 1 K/s", "m*(K/s)^exponent")
STRENGTH_SLOPE = Dimension("a strength times the root of a length", "Pa*m^0.5")


class ArmSpacingData(Description):
    """Spacing of the secondary arms λ2 = C_λ Ṫ^(-n).

    Attributes:
        coefficient: C_λ, the spacing at 1 K/s [m (K/s)^n].
        exponent: n; 0: the spacing is constant.
    """

    coefficient: Annotated[float, PlainQuantity(SPACING_COEFFICIENT, above=0.0, reason="")]
    exponent: Annotated[float, Quantity(PURE_NUMBER, least=0.0, most=1.0)] = RIPENING


class StrengthData(Description):
    """Yield strength by the arm spacing, σ = σ_0 + k λ2^(-½).

    Attributes:
        base: σ_0 [Pa].
        slope: k [Pa m^½].
    """

    base: Annotated[float, Quantity(STRESS)]
    slope: Annotated[float, PlainQuantity(STRENGTH_SLOPE, least=0.0, reason="")]


class FatigueData(Description):
    """Coefficients of the strain-life curve of Basquin, Coffin and Manson.

    Attributes:
        strength: σ_f′ [Pa].
        strength_exponent: b.
        ductility: ε_f′.
        ductility_exponent: c.
    """

    strength: Annotated[float, Quantity(STRESS, above=0.0)]
    strength_exponent: Annotated[float, Quantity(PURE_NUMBER, above=-1.0, below=0.0)]
    ductility: Annotated[float, Quantity(PURE_NUMBER, above=0.0)]
    ductility_exponent: Annotated[float, Quantity(PURE_NUMBER, above=-2.0, below=0.0)]


@dataclass(frozen=True)
class KeysEntry:
    """A table of the keys of a description, for `Annotated[... | None, KeysEntry(...)]`.

    Args:
        model: class of the description.
    """

    model: type[Description]

    def read(self, value: Any) -> Description | None:
        """Return the description.

        Raises:
            CaseError: no table, or a key is refused.
        """
        if value is None or isinstance(value, self.model):
            return value
        if not isinstance(value, dict):
            return self.from_number(value)
        return self.model.read(value)

    def from_number(self, value: Any) -> Description:
        """Return the description that a number stands for.

        Raises:
            CaseError: there is none.
        """
        keys = ", ".join(self.model.model_fields)
        raise CaseError(f"a table of keys is needed: {{ {keys} }}")

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


class ArmSpacingEntry(KeysEntry):
    """A constant spacing [m] or the keys of `ArmSpacingData`."""

    def from_number(self, value: Any) -> Description:
        """Return a spacing independent of the cooling rate.

        Raises:
            CaseError: it is not a positive length.
        """
        spacing = Quantity(LENGTH, above=0.0).read(value)
        return ArmSpacingData.read({"coefficient": spacing, "exponent": 0.0})
