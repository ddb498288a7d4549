"""Material data for foundry quantities; missing data are named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from castx.errors import CaseError
from castx.foundry.arm_spacing import ArmSpacing
from castx.foundry.die_life import Fatigue
from castx.foundry.hot_tearing import clyne_davies_of_alloy, kou
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import CriticalLiquid, Melt, melt_contraction
from castx.materials.description import MaterialDescription
from castx.materials.foundry_data import StrengthData
from castx.materials.material import ATMOSPHERE, Material
from castx.tables import Table

COALESCENCE = 0.98
"""Solid fraction from which dendrites have grown together, where the material has none."""

FEEDING = ("melt_viscosity", "arm_spacing", "solidification_shrinkage")
NEEDED: Mapping[str, tuple[str, ...]] = {
    "dimensionless_niyama": FEEDING,
    "pore_fraction": FEEDING,
    "arm_spacing": ("arm_spacing",),
    "yield_strength": ("arm_spacing", "strength"),
    "tearing_margin": FEEDING,
    "brittle_strain_index": ("critical_strain",),
    "cold_crack_index": ("tensile_strength",),
    "feeding_path": FEEDING,
    "emptied": ("solidification_shrinkage",),
}
"""Keys of a material that a field asks for."""
OF_THE_MUSH = (
    "dimensionless_niyama", "pore_fraction", "feeding_path", "clyne_davies", "brittle_strain",
    "brittle_time", "brittle_strain_index", "tearing_margin",
)  # fmt: skip
"""Fields that a material without a freezing range does not have."""


def missing(material: MaterialDescription, keys: tuple[str, ...]) -> list[str]:
    """Return the keys that a material does not give; a default does not count."""
    return [key for key in keys if key not in material.model_fields_set or
            getattr(material, key) is None]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Alloy:
    """A material as the quantities of the foundry see it.

    Every property raises CaseError, which names the keys that are missing, where to add them, and
    what needs them.

    Args:
        material: complete.
    """

    material: Material

    def _need(self, purpose: str, *keys: str) -> MaterialDescription:
        description, name = self.material.description, self.material.name
        lacking = missing(description, keys)
        if lacking:
            raise CaseError(
                f"material {name!r} has no {', '.join(lacking)}, needed by {purpose}; add to "
                f"[materials.{name}] of the case"
            )
        return description

    @cached_property
    def path(self) -> FreezingPath:
        """Its way of freezing; of a material without a freezing range there is none."""
        material, law = self.material, self.material.solid_fraction
        if law is None or material.solidus is None or material.liquidus is None:
            raise CaseError(f"material {material.name!r} never melts: it has no mush")
        return FreezingPath(law, material.solidus, material.liquidus)

    @property
    def tearing_indices(self) -> dict[str, float | None] | None:
        """Kou's index [K] and the ratio of Clyne and Davies; None: it has no freezing range.

        The ratio is None where no temperature lies between f = 0.4 and 0.9.
        """
        material = self.material
        if material.solidus is None or material.solidus == material.liquidus:
            return None
        ratio = clyne_davies_of_alloy(self.path)
        return {"kou": kou(self.path), "clyne_davies": ratio if np.isfinite(ratio) else None}

    @cached_property
    def critical_liquid(self) -> CriticalLiquid:
        """The liquid fraction at which pores open."""
        return CriticalLiquid(self.path)

    @property
    def spacing(self) -> ArmSpacing:
        """Arm spacing over cooling rate."""
        data = self._need("the arm spacing", "arm_spacing").arm_spacing
        assert data is not None
        return ArmSpacing(data.coefficient, data.exponent)

    @property
    def shrinkage(self) -> float:
        """(ρ_s - ρ_l)/ρ_s."""
        key = "solidification_shrinkage"
        return self._need("the pore fraction", key).solidification_shrinkage

    def melt(self, depression: float = ATMOSPHERE) -> Melt:
        """Return the melt in a mush.

        Args:
            depression: at which pores open, where the material has no `cavitation` [Pa].
        """
        description = self._need("feeding", "melt_viscosity", "solidification_shrinkage")
        assert description.melt_viscosity is not None
        given = description.cavitation
        beta = float(melt_contraction(np.asarray(self.shrinkage)))
        return Melt(description.melt_viscosity, beta, depression if given is None else given)

    @property
    def cut_off(self) -> float:
        """Liquid fraction g_c at which dendrites have grown together."""
        given = self.material.description.coalescence
        return 1.0 - (COALESCENCE if given is None else given)

    @property
    def strength(self) -> StrengthData:
        """Yield strength over arm spacing."""
        data = self._need("the yield strength", "strength").strength
        assert data is not None
        return data

    @property
    def tensile_strength(self) -> Table:
        """R_m over temperature [Pa]."""
        table = self._need("the cold-crack index", "tensile_strength").tensile_strength
        assert table is not None
        return table

    @property
    def critical_strain(self) -> float:
        """Strain that the brittle range bears."""
        strain = self._need("the strain in the brittle range", "critical_strain").critical_strain
        assert strain is not None
        return strain

    @property
    def fatigue(self) -> Fatigue:
        """Strain-life curve."""
        data = self._need("the life of a die surface", "fatigue").fatigue
        assert data is not None
        return Fatigue(
            data.strength, data.strength_exponent, data.ductility, data.ductility_exponent
        )
