"""Contents of the small JSON files of a results folder."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from castx.errors import CaseError
from castx.results.files.folder import write_whole

Contents = TypeVar("Contents", bound="JsonContents")


class JsonContents(BaseModel):
    """Contents of a file, whose numbers are finite."""

    model_config = ConfigDict(frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


def write_json(path: Path, found: JsonContents) -> None:
    """Write a file anew, as a whole or not at all."""
    write_whole(path, found.model_dump_json(indent=2) + "\n")


def read_json(path: Path, kind: type[Contents]) -> Contents | None:
    """Return the contents of a file; None where there is none.

    Raises:
        CaseError: it cannot be read, or holds something else.
    """
    if not path.is_file():
        return None
    try:
        return kind.model_validate_json(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, ValidationError) as error:
        raise CaseError(f"{path} cannot be read: {error}") from None
