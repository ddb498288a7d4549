"""Thermo-mechanics of metal casting: solidification, stresses, contact, and heat across it."""

from typing import Any

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    """Load `castx.run` at its first use: the solvers take a second, the version none."""
    if name == "run":
        from castx.running import run

        return run
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
