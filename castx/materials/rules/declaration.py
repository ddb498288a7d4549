"""Common part of all rules, and the check that a declaration is complete."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from castx.errors import CaseError
from castx.input.registry import refuse_incomplete
from castx.materials.rules.key import RuleKey


class Rule(Protocol):
    """A flow rule or a hardening rule."""

    @property
    def name(self) -> str:
        """Name of the file."""
        ...

    @property
    def keys(self) -> tuple[RuleKey, ...]:
        """Keys that the rule reads."""
        ...

    @property
    def example(self) -> Mapping[str, float]:
        """Values of all keys."""
        ...


def check_declaration(rule: Rule) -> None:
    """Check that a rule is declared completely, and that its example is allowed.

    Raises:
        TypeError: names the texts that are empty and the keys without meaning or example.
    """
    what = f"rule {rule.name!r}"
    refuse_incomplete(what, rule, ("name", "summary", "formula", "source", "keys", "example"))
    for key in rule.keys:
        refuse_incomplete(f"the key {key.name!r} of {what}", key, ("name", "meaning"))
        if key.name not in rule.example:
            raise TypeError(f"{what} declares no example of {key.name!r}")
        try:
            key.entry.read(rule.example[key.name])
        except CaseError as error:
            raise TypeError(f"{what}: example of {key.name!r}: {error}") from None


def keys_of(rules: Iterable[Rule]) -> dict[str, RuleKey]:
    """Return the keys of rules by name.

    Raises:
        TypeError: two rules declare keys of one name differently.
    """
    keys: dict[str, RuleKey] = {}
    for rule in rules:
        for key in rule.keys:
            if keys.setdefault(key.name, key) != key:
                text = f"declares the key {key.name!r} otherwise than another rule does"
                raise TypeError(f"rule {rule.name!r} {text}")
    return keys
