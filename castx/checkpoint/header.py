"""The header of a checkpoint, checked before anything relies on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from castx.errors import CaseError
from castx.input.problems import dotted
from castx.stateful import Array

CURE = "put a whole copy in its place, or start the run anew without --restart"
STATE = ("/heat/enthalpy/", "/mechanics/motion/", "/points/")
"""Parts of the names of arrays that are numbers everywhere."""


class _Header(BaseModel):
    model_config = ConfigDict(strict=True, defer_build=True)
    castx: str
    written: str
    time: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
    step: Annotated[int, Field(ge=0)]
    ranks: int
    mesh: str
    case: dict[str, Any]
    process: dict[str, Any]
    results: dict[str, Any]
    arrays: list[str]


def checked(header: Mapping[str, Any], path: str) -> Mapping[str, Any]:
    """Return a header that has what a run goes on with.

    Args:
        header: as it stands in the file.
        path: of the file, for the refusal.

    Raises:
        CaseError: an entry is missing or of another kind.
    """
    try:
        _Header.model_validate(header)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = dotted(tuple(first["loc"])) or "its header"
        raise CaseError(
            f"the checkpoint {path} is damaged: {where}: {first['msg']}; {CURE}"
        ) from None
    return header


def refuse_what_is_no_number(arrays: Mapping[str, Array], path: str) -> None:
    """Refuse a state with temperatures, displacements or strains that are no numbers.

    Raises:
        CaseError: on this rank.
    """
    for name, values in arrays.items():
        if any(part in f"/{name}" for part in STATE) and not np.isfinite(values).all():
            raise CaseError(f"the checkpoint {path} is damaged: {name} is not a number; {CURE}")
