"""Thermo-mechanics of metal casting: solidification, stresses, contact, and heat across it."""

from typing import Any

from castx.version import __version__

__all__ = ["__version__", "run"]


def __getattr__(name: str) -> Any:
    """Load `castx.run` at its first use: the solvers take a second, the version none."""
    if name == "run":
        from castx.command.run import run

        return run
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
