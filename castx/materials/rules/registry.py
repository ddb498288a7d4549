"""Finding the rules in the files of a folder, and refusing incomplete ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from pkgutil import iter_modules
from typing import Protocol, TypeVar

from castx.errors import CaseError
from castx.materials.rules.key import Key


class Declaration(Protocol):
    """What all kinds of rules declare."""

    @property
    def name(self) -> str:
        """Name of the file."""
        ...

    @property
    def summary(self) -> str:
        """What the rule is, in one sentence."""
        ...

    @property
    def formula(self) -> str:
        """What the rule says."""
        ...

    @property
    def source(self) -> str:
        """Author, year, and where the rule is printed."""
        ...

    @property
    def keys(self) -> tuple[Key, ...]:
        """Keys that the rule reads."""
        ...

    @property
    def example(self) -> Mapping[str, float]:
        """Values of all keys."""
        ...


Rule = TypeVar("Rule", bound=Declaration)


def check_declaration(rule: Declaration) -> None:
    """Check that a rule says what it must.

    Raises:
        TypeError: names the texts that are empty and the keys without an example.
    """
    texts = {name: getattr(rule, name) for name in ("name", "summary", "formula", "source")}
    lacking = [name for name, text in texts.items() if not text.strip()]
    lacking += [] if rule.keys else ["keys"]
    lacking += [f"meaning of {key.name}" for key in rule.keys if not key.meaning]
    lacking += [f"example of {key.name}" for key in rule.keys if key.name not in rule.example]
    if lacking:
        raise TypeError(f"rule {rule.name!r} lacks: {', '.join(lacking)}")
    for key in rule.keys:
        try:
            key.entry.read(rule.example[key.name])
        except CaseError as error:
            raise TypeError(f"rule {rule.name!r}: example of {key.name}: {error}") from None


def rules_of(package: str, kind: type[Rule]) -> tuple[Rule, ...]:
    """Return the rules that the modules of a package declare as `RULE`, by name.

    Args:
        package: full name of the package.
        kind: class of its rules.

    Raises:
        TypeError: a module declares no rule, an incomplete one or one of another name, or two
            rules give one key different kinds; with the module.
    """
    rules = []
    for module in sorted(found.name for found in iter_modules(import_module(package).__path__)):
        try:
            rule = getattr(import_module(f"{package}.{module}"), "RULE", None)
        except TypeError as error:
            raise TypeError(f"{package}.{module}: {error}") from error
        if not isinstance(rule, kind):
            raise TypeError(f"{package}.{module} must declare RULE = {kind.__name__}(...)")
        if rule.name.replace("-", "_") != module:
            raise TypeError(f"{package}.{module}: the rule has another name, {rule.name!r}")
        rules.append(rule)
    keys_of(rules)
    return tuple(rules)


def keys_of(rules: Iterable[Declaration]) -> dict[str, Key]:
    """Return the keys of rules by name.

    Raises:
        TypeError: two rules declare one key differently.
    """
    keys: dict[str, Key] = {}
    for rule in rules:
        for key in rule.keys:
            if keys.setdefault(key.name, key) != key:
                raise TypeError(f"rule {rule.name!r}: another rule has another key {key.name!r}")
    return keys
