"""Versions of the software underneath, and the speed of its BLAS."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from castx.commit import commit
from castx.version import __version__

PACKAGES = {
    "fenics-dolfinx": "dolfinx",
    "fenics-ufl": "ufl",
    "petsc4py": "petsc4py",
    "mpi4py": "mpi4py",
    "gmsh": "gmsh",
    "numpy": "numpy",
    "pyvista": "pyvista",
}
"""Modules by the names of their packages."""
# On one thread OpenBLAS is 6 to 9 times as fast as a plain loop, the reference BLAS 0.6 to 1.
FEWEST_TIMES_FASTER = 2.5


def versions() -> dict[str, str]:
    """Return the versions of castx, Python and the packages underneath, or "missing".

    That of castx stands before the commit of its sources, or "unknown".
    """
    found = {"castx": __version__, "commit": commit(), "python": platform.python_version()}
    return found | {package: _version(package, module) for package, module in PACKAGES.items()}


def _version(package: str, module: str) -> str:
    """Return the version of a package, asking the module where a wheel of others brings it."""
    try:
        return version(package)
    except PackageNotFoundError:
        pass
    try:
        return str(import_module(module).__version__)
    except ModuleNotFoundError:
        return "missing"


def blas_advantage() -> float:
    """Return the speed of matrix products by the BLAS over that of a plain loop.

    The ratio hardly depends on the machine and its load. Measuring it takes 10 ms.
    """
    matrix = np.full((200, 200), 0.5)
    plain = _shortest_time(lambda: np.einsum("ij,kj->ik", matrix, matrix))
    return plain / _shortest_time(lambda: matrix @ matrix)


def blas_warning(advantage: float) -> str | None:
    """Return a warning about a slow BLAS, or None.

    Args:
        advantage: how many times faster than a plain loop it is.
    """
    if advantage > FEWEST_TIMES_FASTER:
        return None
    return (
        "the BLAS in use is slow, no better than a plain loop: the solvers' dense kernels take "
        "about ten times longer than they need; install OpenBLAS "
        "(Debian: apt install libopenblas0-pthread)"
    )


def _shortest_time(call: Callable[[], object]) -> float:
    """Return the time of the fastest of three calls [s]."""
    times = []
    for _ in range(3):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)
