"""Names of the casting processes that come with castx, which `castx new --help` shows at once."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

FOLDER = files("castx.case.processes") / "database"


@cache
def process_names() -> tuple[str, ...]:
    """Return the names of all processes in alphabetical order."""
    found = (entry.name for entry in FOLDER.iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in found if name.endswith(".toml")))
