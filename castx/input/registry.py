"""Registries: declarations in the files of a package, found without a list typed by hand."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import Protocol, TypeVar


class Declaration(Protocol):
    """Declaration of a law, a rule or a method in a file."""

    @property
    def name(self) -> str:
        """Name in the case file; that of the file, mostly with hyphens for underscores."""


D = TypeVar("D", bound=Declaration)


def modules_of(package: str, besides: Collection[str] = ()) -> Iterator[ModuleType]:
    """Yield the modules of a package in alphabetical order, imported.

    Args:
        package: full name of the package.
        besides: names of modules that are left out.

    Raises:
        TypeError: a declaration is not complete; with the name of its module.
    """
    for entry in iter_modules(import_module(package).__path__):
        if entry.name not in besides:
            yield _imported(f"{package}.{entry.name}")


def _imported(name: str) -> ModuleType:
    try:
        return import_module(name)
    except TypeError as error:
        raise TypeError(f"{name}: {error}") from error


def declarations(
    package: str,
    variable: str,
    kind: type[D],
    besides: Collection[str] = (),
    *,
    hyphens: bool = True,
) -> dict[str, D]:
    """Return the declarations in the files of a package, by name in alphabetical order.

    Args:
        package: full name of the package.
        variable: name of the variable that holds the declaration in each file.
        kind: class of the declarations.
        besides: names of modules that declare nothing.
        hyphens: whether names have hyphens where those of files have underscores.

    Raises:
        TypeError: a file declares nothing, or a name that is not its own.
    """
    found = {}
    for module in modules_of(package, besides):
        declared = getattr(module, variable, None)
        if not isinstance(declared, kind):
            raise TypeError(f"{module.__name__} declares no {variable} = {kind.__name__}(...)")
        file = module.__name__.rpartition(".")[2]
        expected = file.replace("_", "-") if hyphens else file
        if declared.name != expected:
            text = f"{variable}.name is {declared.name!r}, not {expected!r} as its file is called"
            raise TypeError(f"{module.__name__}: {text}")
        found[declared.name] = declared
    return dict(sorted(found.items()))


def refuse_incomplete(what: str, declaration: object, attributes: tuple[str, ...]) -> None:
    """Refuse a declaration in which something is left out.

    Args:
        what: kind and name of the declaration, for the message.
        declaration: the object.
        attributes: names of those that must not be empty.

    Raises:
        TypeError: with the names of all that are missing.
    """
    missing = [name for name in attributes if not getattr(declaration, name)]
    if missing:
        raise TypeError(f"{what} declares no {', no '.join(missing)}")
