"""The commit of the sources from which this castx was built, or from which it runs.

`setup.py` writes it into distributions, as `castx/commit.txt`; a checkout keeps it in `.git`, whose
files are read here, since git may not be there.
"""

from __future__ import annotations

import re
from pathlib import Path

PACKAGE = Path(__file__).parent
BUILT = "commit.txt"
UNKNOWN = "unknown"
_COMMIT = re.compile(r"[0-9a-f]{40,64}")


def commit(package: Path = PACKAGE) -> str:
    """Return the commit of castx, or "unknown".

    Changes of a checkout that are not committed are not seen.

    Args:
        package: folder of castx.
    """
    built = _text(package / BUILT)
    if _COMMIT.fullmatch(built):
        return built
    return checked_out(package.parent) or UNKNOWN


def checked_out(checkout: Path) -> str | None:
    """Return the commit that is checked out in a folder; None: it is no checkout of git."""
    folder = checkout / ".git"
    if folder.is_file():  # a further working tree
        folder = checkout / _text(folder).removeprefix("gitdir: ")
    head = _text(folder / "HEAD")
    if not head.startswith("ref: "):
        return head if _COMMIT.fullmatch(head) else None
    name = head.removeprefix("ref: ")
    common = folder / (_text(folder / "commondir") or ".")
    for place in (folder, common):
        if _COMMIT.fullmatch(found := _text(place / name)):
            return found
    packed = re.search(rf"^([0-9a-f]+) {re.escape(name)}$", _text(common / "packed-refs"), re.M)
    return packed[1] if packed else None


def _text(file: Path) -> str:
    """Return the text of a file; "" if it cannot be read."""
    try:
        return file.read_text(encoding="utf-8").strip()
    except (OSError, ValueError):
        return ""
