"""All contact methods, found by their files, in the order of the kinds of their unknowns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from types import ModuleType
from typing import NamedTuple

from castx.contact.methods.description import ContactMethod, Key, Setting, Settings, UnknownKind
from castx.input.registry import modules_of

_NO_METHODS = ("description", "registry")
_TEXTS = ("name", "summary", "formula", "source", "advice")


class MethodRow(NamedTuple):
    """A method in the manual.

    Attributes:
        name: word of the case file.
        summary: what it does.
        keys: of the case file that it uses.
        formula: its equations.
        source: where they stand.
        advice: when to use it.
    """

    name: str
    summary: str
    keys: tuple[str, ...]
    formula: str
    source: str
    advice: str


def described(module: ModuleType) -> ContactMethod:
    """Return the method that a file declares as `METHOD`.

    Raises:
        TypeError: the description is missing or incomplete; names what is missing.
    """
    file = f"contact method {module.__name__}"
    method = getattr(module, "METHOD", None)
    if not isinstance(method, ContactMethod):
        raise TypeError(f"{file}: METHOD is missing, a ContactMethod that describes it")
    problems = list(_problems(method, module.__name__.rpartition(".")[2]))
    if problems:
        raise TypeError(f"{file}: {'; '.join(problems)}")
    return method


def _problems(method: ContactMethod, file: str) -> Iterator[str]:
    for text in _TEXTS:
        if not getattr(method, text).strip():
            yield f"{text} is missing"
    if method.name != file.replace("_", "-"):
        yield f"name {method.name!r} is not that of the file"
    for key in method.keys:
        if not key.summary.strip():
            yield f"summary of the key {key.name!r} is missing"
    if (method.pair_law is not None) != (method.unknowns is UnknownKind.DISPLACEMENTS):
        yield "pair_law is missing" if method.pair_law is None else "pair_law has no use"


def ordered(methods: Iterable[ContactMethod]) -> dict[str, ContactMethod]:
    """Return methods in the order of `UnknownKind`, of equal kinds by their names.

    Raises:
        TypeError: two methods mean different things by one key.
    """
    kinds = list(UnknownKind)
    found = sorted(methods, key=lambda method: (kinds.index(method.unknowns), method.name))
    keys: dict[str, Key] = {}
    for method in found:
        for key in method.keys:
            if keys.setdefault(key.name, key) != key:
                raise TypeError(f"contact method {method.name}: key {key.name!r} has two meanings")
    return {method.name: method for method in found}


METHODS: Mapping[str, ContactMethod] = ordered(
    described(module) for module in modules_of("castx.contact.methods", _NO_METHODS)
)
"""All methods by the word of the case file."""

DEFAULT = "condensed"
"""The method where a case names none."""


def names(where: Callable[[ContactMethod], bool] = lambda _: True) -> tuple[str, ...]:
    """Return the names of the methods for which a condition is true."""
    return tuple(name for name, method in METHODS.items() if where(method))


def contact_methods() -> dict[str, ContactMethod]:
    """Return all contact methods by name.

    >>> import castx
    >>> castx.contact_methods()["penalty"].formula
    'p_c = ε⟨-g⟩'
    """
    return dict(METHODS)


def keys() -> dict[str, Key]:
    """Return the keys of all methods by name."""
    return {key.name: key for method in METHODS.values() for key in method.keys}


def users(key: str) -> tuple[str, ...]:
    """Return the names of the methods that use a key."""
    return names(lambda method: method.uses(key))


def setting(settings: Settings, key: str) -> Setting:
    """Return the value of a key, its default where it is left out."""
    return settings.get(key, keys()[key].default)


def method_table() -> list[MethodRow]:
    """Return a row for each method, for the manual."""
    return [
        MethodRow(
            m.name, m.summary, tuple(key.name for key in m.keys), m.formula, m.source, m.advice
        )
        for m in METHODS.values()
    ]
