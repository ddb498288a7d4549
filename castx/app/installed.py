"""Whether the page can be served: the packages of the extra `app`, and one rank."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec

from castx.errors import CaseError

PACKAGES = ("starlette", "uvicorn")


def refuse_missing_server(ranks: int, packages: Sequence[str] = PACKAGES) -> None:
    """Refuse to serve the page where that cannot be done.

    Raises:
        CaseError: packages are missing, or there are several ranks.
    """
    if ranks > 1:
        raise CaseError("castx app is one process: start it without mpirun")
    missing = [name for name in packages if find_spec(name) is None]
    if missing:
        raise CaseError(
            f"castx app needs {' and '.join(missing)}: pip install 'castx[app]', or in Debian "
            f"apt install {' '.join(f'python3-{name}' for name in missing)}"
        )
