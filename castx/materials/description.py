"""The keys of a material in a case file or in the database, checked one by one and together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from castx.errors import CaseError
from castx.input.entries import (
    Choice,
    Description,
    MaterialName,
    Quantity,
    Tabulated,
    Temperature,
    over_temperature,
)
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import (
    CONDUCTIVITY,
    DENSITY,
    EXPANSION,
    HEAT_CAPACITY,
    LATENT_HEAT,
    PURE_NUMBER,
    STRESS,
    TEMPERATURE,
    VISCOSITY,
)
from castx.materials.foundry_data import (
    ArmSpacingData,
    ArmSpacingEntry,
    FatigueData,
    KeysEntry,
    StrengthData,
)
from castx.materials.granular import GranularData
from castx.materials.inelastic import (
    DEFAULT_LAW,
    FLOW_RULES,
    KINEMATIC_KEYS,
    LIQUID_RULES,
    RATE_KEYS,
    Hardening,
    HardeningEntry,
    inelastic_problems,
    with_keys,
)
from castx.materials.phased import Phased
from castx.materials.rules.declaration import keys_of
from castx.materials.rules.key import PeoplesUnit
from castx.materials.solid_fraction import TabulatedLaw
from castx.tables import Table

ALLOY_LAWS = ("lever", "scheil")
LAW_NAMES = ("linear", *ALLOY_LAWS)
_PHASES = ("solid", "liquid")
_FRACTION = Quantity(PURE_NUMBER, least=0.0, most=1.0)
_DEGREES = Quantity(TEMPERATURE)
ZERO = Table.constant(0.0)


@dataclass(frozen=True)
class PhasedTable:
    """A number or table, or one for each of solid and liquid, for `Annotated[Phased, ...]`."""

    table: Tabulated

    def read(self, value: Any) -> Phased:
        """Return the property of both phases.

        Raises:
            CaseError: an unknown or a missing phase, or a refused number.
        """
        if isinstance(value, Phased):
            return value
        if not isinstance(value, dict):
            return Phased.uniform(self.table.read(value))
        for name in value:
            if name not in _PHASES:
                raise refuse(f"unknown; {among(str(name), _PHASES)}", name)
        missing = [name for name in _PHASES if name not in value]
        if missing:
            raise CaseError(f"{missing[0]} is missing; a value for both phases needs no keys")
        return Phased(*(self._phase(name, value[name]) for name in _PHASES))

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        schema = self.table.json_schema()
        said = f"{schema['description']}; or {{ {', '.join(_PHASES)} }} with one of each"
        return {"type": [*schema["type"], "object"], "description": said}

    def _phase(self, name: str, value: Any) -> Table:
        try:
            return self.table.read(value)
        except Refusal as refusal:
            raise refusal.inside(name) from None
        except CaseError as error:
            raise refuse(str(error), name) from None

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


class SolidFractionEntry:
    """The name of a law of solidification or its table, for `Annotated[...]`."""

    def read(self, value: Any) -> str | TabulatedLaw:
        """Return the name, or the table without rows below its solidus and above its liquidus.

        Raises:
            CaseError: an unknown name, or a table that is not a solid fraction.
        """
        if isinstance(value, TabulatedLaw) or (isinstance(value, str) and value in LAW_NAMES):
            return value
        if not isinstance(value, list | tuple):
            near = value if isinstance(value, str) else ""
            names = among(near, LAW_NAMES, what="allowed")
            raise CaseError(f"unknown; {names}, or a table of (°C, solid fraction)")
        rows = [self._row(index, row) for index, row in enumerate(value)]
        for index in range(1, len(rows)):
            if rows[index][0] < rows[index - 1][0] or rows[index][1] > rows[index - 1][1]:
                text = "temperatures must not decrease and solid fractions must not increase"
                raise refuse(f"{text} from row to row", index)
        freezing = _freezing_rows(rows)
        if len(freezing) < 2 or freezing[0][1] == freezing[-1][1]:
            raise CaseError("the solid fraction must fall from the first row to the last")
        return TabulatedLaw(freezing)

    def _row(self, index: int, row: Any) -> tuple[float, float]:
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise refuse("a row needs a temperature and a solid fraction", index)
        try:
            return _DEGREES.read(row[0]), _FRACTION.read(row[1])
        except CaseError as error:
            raise refuse(str(error), index) from None

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


def _freezing_rows(rows: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Drop all rows of fraction 1 but the hottest, and all of fraction 0 but the coldest."""
    solid = sum(fraction == 1.0 for _, fraction in rows)
    liquid = sum(fraction == 0.0 for _, fraction in rows)
    return tuple(rows[max(solid - 1, 0) : len(rows) - max(liquid - 1, 0)])


NEWTONIAN = "viscous"
_LIQUID_KEYS = {NEWTONIAN: ("viscosity",)} | {
    name: tuple(key.name for key in rule.keys) for name, rule in LIQUID_RULES.items()
}
_LIQUID_NEEDS = {NEWTONIAN: ("viscosity",)} | {
    name: rule.needed for name, rule in LIQUID_RULES.items()
}


@with_keys(keys_of(LIQUID_RULES.values()))
class Liquid(Description):
    """Flow of a material where nothing in it bears: in alloys below coherency.

    viscous: s = 2 viscosity ė, Newtonian; else by the flow rule of this name. Coherency has no
    meaning in metal that freezes at one temperature.
    """

    model: Annotated[str, Choice(tuple(_LIQUID_KEYS))] = NEWTONIAN
    viscosity: Annotated[Table, over_temperature(VISCOSITY, above=0.0)] = ZERO
    coherency: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=1.0)]

    @property
    def is_newtonian(self) -> bool:
        """Whether its stress is linear in the rate of strain."""
        return self.model == NEWTONIAN

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield keys that the model needs, and keys that it would ignore."""
        for key in _LIQUID_NEEDS[self.model]:
            if key not in self.model_fields_set:
                yield Problem((key,), f'missing; model = "{self.model}" needs it')
        own = {"model", "coherency", *_LIQUID_KEYS[self.model]}
        for key in sorted(self.model_fields_set - own):
            models = " or ".join(f'"{name}"' for name, keys in _LIQUID_KEYS.items() if key in keys)
            text = f'acts only with model = {models}, and here it is "{self.model}"'
            yield Problem((key,), f"{text}; leave it out or change model")


class LiquidEntry:
    """The keys of `Liquid`, or "none" to go without, for `Annotated[Liquid | None, ...]`."""

    def read(self, value: Any) -> Liquid | None:
        """Return the liquid.

        Raises:
            CaseError: neither of both, or a key is refused.
        """
        if value is None or value == "none":
            return None
        if not isinstance(value, dict | Liquid):
            raise CaseError('a table of keys is needed, or "none": elastic at every temperature')
        return value if isinstance(value, Liquid) else Liquid.read(value)

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@with_keys(KINEMATIC_KEYS | RATE_KEYS)
class MaterialDescription(Description):
    """Properties of a material as given; with `extends`, only the changed ones.

    `law` names the flow rule of the solid. The keys of the flow rules and of the kinematic
    hardening rules are fields too, added by `with_keys`.
    """

    extends: MaterialName | None = None
    density: Annotated[float, Quantity(DENSITY, above=0.0)] | None = None
    heat_capacity: (
        Annotated[Phased, PhasedTable(over_temperature(HEAT_CAPACITY, above=0.0))] | None
    ) = None
    conductivity: (
        Annotated[Phased, PhasedTable(over_temperature(CONDUCTIVITY, above=0.0))] | None
    ) = None
    latent_heat: (
        Annotated[float, Quantity(LATENT_HEAT, least=0.0), PeoplesUnit("kJ/kg", 1e-3)] | None
    ) = None
    solidus: Temperature | None = None
    liquidus: Temperature | None = None
    solid_fraction: Annotated[str | TabulatedLaw, SolidFractionEntry()] = "linear"
    partition_coefficient: Annotated[float, Quantity(PURE_NUMBER, above=0.0, below=1.0)] | None = (
        None
    )
    melting_point: Temperature | None = None
    young_modulus: (
        Annotated[Table, over_temperature(STRESS, above=0.0), PeoplesUnit("GPa", 1e-9)] | None
    ) = None
    poisson_ratio: Annotated[Table, over_temperature(PURE_NUMBER, least=0.0, below=0.5)] | None = (
        None
    )
    expansion: Annotated[Table, over_temperature(EXPANSION), PeoplesUnit("µm/m/K", 1e6)] | None = (
        None
    )
    expansion_reference: Temperature | None = None
    stress_free: Temperature | None = None
    liquid: Annotated[Liquid | None, LiquidEntry()] = None
    solidification_shrinkage: Annotated[float, Quantity(PURE_NUMBER, above=-1.0, below=1.0)] = 0.0
    cavitation: Annotated[float, Quantity(STRESS, least=0.0)] | None = None
    yield_stress: (
        Annotated[Table, over_temperature(STRESS, least=0.0), PeoplesUnit("MPa", 1e-6)] | None
    ) = None
    hardening: Annotated[Hardening, HardeningEntry()] = HardeningEntry().read(0.0)
    law: Annotated[str, Choice(tuple(FLOW_RULES))] = DEFAULT_LAW
    granular: Annotated[GranularData | None, KeysEntry(GranularData)] = None
    dissipation: Annotated[float, Quantity(PURE_NUMBER, least=0.0, most=1.0)] = 0.9
    melt_viscosity: Annotated[float, Quantity(VISCOSITY, above=0.0)] | None = None
    arm_spacing: Annotated[ArmSpacingData | None, ArmSpacingEntry(ArmSpacingData)] = None
    coalescence: Annotated[float, Quantity(PURE_NUMBER, above=0.0, below=1.0)] | None = None
    critical_strain: Annotated[float, Quantity(PURE_NUMBER, above=0.0)] | None = None
    strength: Annotated[StrengthData | None, KeysEntry(StrengthData)] = None
    tensile_strength: (
        Annotated[Table, over_temperature(STRESS, above=0.0), PeoplesUnit("MPa", 1e-6)] | None
    ) = None
    fatigue: Annotated[FatigueData | None, KeysEntry(FatigueData)] = None

    @property
    def freezing_range(self) -> tuple[float, float] | None:
        """Solidus and liquidus [°C], given or the ends of the table; None: it never melts."""
        if isinstance(self.solid_fraction, TabulatedLaw):
            return self.solid_fraction.solidus, self.solid_fraction.liquidus
        if self.solidus is None or self.liquidus is None:
            return None
        return self.solidus, self.liquidus

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield properties that contradict each other; of an extension, when it is complete."""
        if self.extends is not None:
            return
        unclear = list(self._range_problems())
        if unclear:
            yield from unclear
        elif self.freezing_range is None:
            yield from self._never_melting_problems()
        else:
            yield from self._melting_problems(*self.freezing_range)
        if self.expansion_reference is not None and self.expansion is None:
            text = "the reference of an expansion that is not given; add expansion"
            yield Problem(("expansion_reference",), text)
        yields = self.yield_stress is not None
        yield from inelastic_problems(self, self.law, self.hardening, yields)

    def _range_problems(self) -> Iterator[Problem]:
        if isinstance(self.solid_fraction, TabulatedLaw):
            for key in ("solidus", "liquidus"):
                own = getattr(self.solid_fraction, key)
                if getattr(self, key) not in (None, own):
                    text = f"the table solid_fraction says {own:g} °C; leave {key} out"
                    yield Problem((key,), text)
        elif (self.solidus is None) != (self.liquidus is None):
            missing, given = ("solidus", "liquidus")[:: 1 if self.solidus is None else -1]
            text = f"missing; give it with {given} (equal for an isothermal change)"
            yield Problem((missing,), text)
        elif self.solidus is not None and self.liquidus is not None:
            if self.solidus > self.liquidus:
                text = f"{self.solidus:g} °C lies above the liquidus, {self.liquidus:g} °C"
                yield Problem(("solidus",), text)

    def _never_melting_problems(self) -> Iterator[Problem]:
        cure = "acts only in a material that melts; give solidus and liquidus or leave it out"
        for key in (
            "latent_heat", "liquid", "partition_coefficient", "melting_point", "cavitation",
            "melt_viscosity", "arm_spacing", "coalescence", "critical_strain", "strength",
        ):  # fmt: skip
            if getattr(self, key) is not None:
                yield Problem((key,), cure)
        if self.solidification_shrinkage:
            yield Problem(("solidification_shrinkage",), cure)
        if "solid_fraction" in self.model_fields_set:
            yield Problem(("solid_fraction",), cure)
        for key in ("heat_capacity", "conductivity"):
            phased = getattr(self, key)
            if phased is not None and phased.liquid is not phased.solid:
                yield Problem((key, "liquid"), cure)

    def _melting_problems(self, solidus: float, liquidus: float) -> Iterator[Problem]:
        if self.latent_heat is None:
            text = "missing; a material that melts needs it (0 is allowed)"
            yield Problem(("latent_heat",), text)
        alloy = self.solid_fraction in ALLOY_LAWS
        for key in ("partition_coefficient", "melting_point"):
            value = getattr(self, key)
            if alloy and value is None:
                yield Problem((key,), f'missing; solid_fraction = "{self.solid_fraction}" needs it')
            elif not alloy and value is not None:
                text = 'acts only with solid_fraction = "lever" or "scheil"; leave it out'
                yield Problem((key,), text)
        if alloy and solidus == liquidus:
            text = "solidus and liquidus are equal; an isothermal change has no other law"
            yield Problem(("solid_fraction",), f'{text}, use "linear"')
        if alloy and self.melting_point is not None and self.melting_point <= liquidus:
            text = f"must lie above the liquidus, {liquidus:g} °C"
            yield Problem(("melting_point",), text)
