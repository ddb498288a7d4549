"""The same case in a mesh with other sizes, and with the errors that tell them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from castx.case.case import Case
from castx.case.fields.heat import FLUX_ERROR
from castx.case.fields.stress import STRESS_ERROR
from castx.case.reading.read import read_case


def error_fields(case: Case) -> tuple[str, ...]:
    """Return the names of the errors in cells that a run of the case can write."""
    with_heat, with_stress = (case.coupling.scheme != name for name in ("mechanical", "thermal"))
    return (STRESS_ERROR,) * with_stress + (FLUX_ERROR,) * with_heat


def with_fields(case: Case, names: Sequence[str]) -> Case:
    """Return the case with other entries of output.fields.

    Args:
        case: that was read from a file.
        names: the entries.
    """
    output = dict(case.content.get("output", {})) | {"fields": list(names)}
    return read_case(case.content | {"output": output}, case.path, "with errors in its cells")


def with_size_map(case: Case, path: Path) -> Case:
    """Return the case in a mesh with the sizes of a file.

    Args:
        case: that was read from a file.
        path: of sizes over space, absolute.
    """
    geometry = dict(case.content["geometry"]) | {"size_map": str(path)}
    return read_case(case.content | {"geometry": geometry}, case.path, "in an adapted mesh")
