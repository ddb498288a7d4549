"""Nothing that lies in the folder in which a program starts is executed or obeyed.

Some libraries look for settings there while they are imported, and these settings can run code or
write files: PETSc takes `.petscrc`, petsc4py `petsc.cfg` (the place of its own machine code),
DOLFINx and FFCx their `…_options.json` (arguments of the C compiler), matplotlib `matplotlibrc`
(a module to import), UCX below MPI `ucx.conf` (libraries to load). A case may lie in a folder that
somebody else has filled. So they are imported elsewhere, in the root of the file system, and those
that look only when they are first used are asked for their settings there.

The settings of a user in his home folder and in environment variables stay as they are.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from castx.signals import hand_back

ELSEWHERE = os.sep
LOOKING = ("mpi4py.MPI", "petsc4py.PETSc", "ffcx", "dolfinx", "matplotlib")
"""Modules that look for settings when they are imported or first used."""


@contextmanager
def elsewhere() -> Iterator[None]:
    """Work in another folder than the present one, and come back."""
    try:
        here = os.open(os.curdir, getattr(os, "O_PATH", os.O_RDONLY))
    except OSError:  # it is gone, and nothing lies there
        yield
        return
    try:
        os.chdir(ELSEWHERE)
        yield
    finally:
        os.fchdir(here)
        os.close(here)


class ImportedElsewhere(MetaPathFinder):
    """Finds a few modules like the finders behind it, and has them loaded elsewhere."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the specification of a module that looks for settings; None: of another one."""
        if fullname not in LOOKING:
            return None
        finders = (finder for finder in sys.meta_path if finder is not self)
        with elsewhere():  # mpi4py of wheels loads MPI in order to find its own module
            specs = (finder.find_spec(fullname, path, target) for finder in finders)
            spec = next((spec for spec in specs if spec is not None), None)
        if spec is not None and spec.loader is not None:
            loader: Any = spec.loader
            loader.create_module = _elsewhere(loader.create_module)
            loader.exec_module = _elsewhere(loader.exec_module, _settle)
        return spec


def import_elsewhere() -> None:
    """Have such modules imported elsewhere from now on."""
    if not any(isinstance(finder, ImportedElsewhere) for finder in sys.meta_path):
        sys.meta_path.insert(0, ImportedElsewhere())


def _elsewhere(
    action: Callable[[Any], Any], afterwards: Callable[[Any], None] | None = None
) -> Callable[[Any], Any]:
    def act(subject: Any) -> Any:
        with elsewhere():
            found = action(subject)
            if afterwards is not None:
                afterwards(subject)
        return found

    return act


def _settle(module: ModuleType) -> None:
    """Let a module look for settings now, and have its signals handed back."""
    if module.__name__ == "ffcx":
        import_module("ffcx.options").get_options()
    elif module.__name__ == "dolfinx":
        import_module("dolfinx.jit").get_options()
    elif module.__name__ == "petsc4py.PETSc":
        hand_back()
