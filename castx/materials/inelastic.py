"""Yielding, hardening and creep in the case file: the keys of all rules, and their checks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, Any, NamedTuple, TypeVar

from pydantic import BaseModel, GetCoreSchemaHandler, create_model
from pydantic_core import CoreSchema, core_schema

from castx.input.entries import Description
from castx.input.problems import Problem
from castx.input.registry import declarations
from castx.materials.rules.declaration import keys_of
from castx.materials.rules.flow_rule import FlowRule
from castx.materials.rules.hardening_rule import HardeningRule
from castx.materials.rules.key import RuleKey
from castx.tables import Table

Model = TypeVar("Model", bound=BaseModel)

_BY_NAME = declarations("castx.materials.flow_rules", "RULE", FlowRule)
FLOW_RULES: Mapping[str, FlowRule] = {
    rule.name: rule for rule in sorted(_BY_NAME.values(), key=lambda rule: not rule.is_default)
}
"""The flow rules by the name of `law`, the default first."""

(DEFAULT_LAW,) = (rule.name for rule in FLOW_RULES.values() if rule.is_default)

LIQUID_RULES: Mapping[str, FlowRule] = {
    name: rule for name, rule in FLOW_RULES.items() if not rule.threshold
}
"""The flow rules by which a liquid can flow, by the name of `liquid.model`."""

HARDENING_RULES = tuple(declarations("castx.materials.hardening", "RULE", HardeningRule).values())
ISOTROPIC_RULES = tuple(rule for rule in HARDENING_RULES if rule.isotropic)
KINEMATIC_RULES = tuple(rule for rule in HARDENING_RULES if not rule.isotropic)

RATE_KEYS = keys_of(FLOW_RULES.values())
"""The keys of all flow rules."""

KINEMATIC_KEYS = keys_of(KINEMATIC_RULES)


def flow_rules() -> Mapping[str, FlowRule]:
    """Return all flow rules by name, the default first.

    >>> import castx
    >>> norton = castx.flow_rules()["norton"]
    >>> norton.formula
    'A qⁿ exp(−Q/(R T_K))'
    >>> norton.needed
    ('coefficient',)
    """
    return FLOW_RULES


class RuleRow(NamedTuple):
    """A rule in the tables of the manual.

    Attributes:
        name: in the case file.
        summary: the rule in one sentence.
        keys: each with its SI unit and default.
        formula: rate, hardening or back stress.
        source: author, year, and where it is printed.
    """

    name: str
    summary: str
    keys: tuple[str, ...]
    formula: str
    source: str


def rule_table(rules: Iterable[FlowRule | HardeningRule]) -> list[RuleRow]:
    """Return the rows of a table of rules.

    Args:
        rules: `FLOW_RULES.values()` or `HARDENING_RULES`.
    """
    return [
        RuleRow(
            rule.name, rule.summary, tuple(key.text for key in rule.keys), rule.formula, rule.source
        )
        for rule in rules
    ]


def with_keys(keys: Mapping[str, RuleKey]) -> Callable[[type[Model]], type[Model]]:
    """Return a decorator that adds the keys of rules to a description, as optional fields."""
    fields: dict[str, Any] = {
        name: (
            Annotated[Table, KeyEntry(key)] | None if key.default is None
            else Annotated[Table, KeyEntry(key)],
            key.default_table,
        )
        for name, key in keys.items()
    }  # fmt: skip

    def extended(model: type[Model]) -> type[Model]:
        return create_model(
            model.__name__, __base__=model, __module__=model.__module__, __doc__=model.__doc__,
            **fields,
        )  # fmt: skip

    return extended


class KeyEntry:
    """A key of a rule as a field of a description.

    Args:
        key: name and kind of the values.
    """

    def __init__(self, key: RuleKey) -> None:
        self.key = key

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.key.entry.read)


@with_keys(keys_of(ISOTROPIC_RULES))
class Hardening(Description):
    """Isotropic hardening R(ξ) over temperature: the sum of all isotropic hardening rules."""

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield rules of which some keys are missing, and a table without any."""
        given = self.model_fields_set
        for rule in ISOTROPIC_RULES:
            others = " and ".join(key.name for key in rule.keys if key.name in given)
            for key in rule.keys:
                if others and key.name not in given:
                    text = f"missing; it is needed with {others} ({rule.title})"
                    yield Problem((key.name,), text)
        if not given:
            sets = (
                " and ".join(key.name for key in rule.keys)
                + (f" ({rule.title})" if rule.title else "")
                for rule in ISOTROPIC_RULES
            )
            yield Problem((), f"needs {', or '.join(sets)}")

    @property
    def acts(self) -> bool:
        """Whether there is any hardening."""
        return any(rule.acts(self) for rule in ISOTROPIC_RULES)


class HardeningEntry:
    """A linear modulus or the keys of `Hardening`, for `Annotated[Hardening, ...]`."""

    _plain = "linear"

    def read(self, value: Any) -> Hardening:
        """Return the hardening.

        Raises:
            CaseError: a key, a number or a table is refused.
        """
        if isinstance(value, dict):
            return Hardening.read(value)
        if isinstance(value, Hardening):
            return value
        entry = keys_of(ISOTROPIC_RULES)[self._plain].entry
        return Hardening.read({self._plain: entry.read(value)})

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


def inelastic_problems(
    material: Description, law: str, hardening: Hardening, yields: bool
) -> Iterator[Problem]:
    """Yield keys that would be ignored whatever the law of the body, and values that do not fit.

    Args:
        material: with the keys of all rules.
        law: name of its flow rule.
        hardening: its isotropic hardening.
        yields: whether it has a yield stress.
    """
    rule = FLOW_RULES[law]
    own = {key.name for key in rule.keys}
    for name in RATE_KEYS:
        if name in material.model_fields_set and name not in own:
            laws = " or ".join(f'"{other}"' for other in rules_with(name, FLOW_RULES))
            text = f'acts only with law = {laws}, and here it is "{law}"'
            yield Problem((name,), f"{text}; leave it out or change law")
    for name, text in rule.problems(rule.tables(material)):
        yield Problem((name,), text)
    if not yields:
        text = "acts only with yield_stress; add it or leave this key out"
        if hardening.acts:
            yield Problem(("hardening",), text)
        for kinematic in KINEMATIC_RULES:
            if kinematic.acts(material):
                yield Problem((kinematic.keys[0].name,), text)


def rules_with(key: str, rules: Mapping[str, FlowRule]) -> list[str]:
    """Return the names of the rules that read a key."""
    return [name for name, rule in rules.items() if key in (own.name for own in rule.keys)]
