"""The same case in a coarser mesh, or in larger steps: what its errors are estimated with."""

from __future__ import annotations

from typing import Any

from castx.case.case import Case
from castx.case.reading.read import read_case
from castx.errors import CaseError

STEP_KEYS = (
    "first_step", "largest_step", "smallest_step", "fixed_step",
    "temperature_change", "solid_fraction_change", "skin_change",
)  # fmt: skip
"""Keys of `time` that say how large steps are."""
SHARES = ("solid_fraction_change", "skin_change")
"""Those of them that are shares of a whole."""


def with_coarser_mesh(case: Case, ratio: float) -> Case:
    """Return the case with all sizes of its cells enlarged.

    Args:
        case: that was read from a file.
        ratio: of the new to the old sizes.

    Raises:
        CaseError: the mesh is a file, or nothing can be meshed with such cells.
    """
    geometry: dict[str, Any] = dict(case.content["geometry"])
    cad, arguments = case.geometry.cad, case.geometry.arguments
    if cad is not None:
        geometry["refinement"] = cad.refinement / ratio
    elif case.geometry.generator is not None:
        sizes = {key: arguments.get(key) for key in ("size", "interface_size")}
        geometry |= {key: ratio * size for key, size in sizes.items() if size is not None}
        if sizes["interface_size"] is None:
            geometry.pop("interface_size", None)
    else:
        raise CaseError("the mesh of a file cannot be made coarser here")
    return read_case(case.content | {"geometry": geometry}, case.path, "in a coarser mesh")


def with_larger_steps(case: Case, ratio: float) -> Case:
    """Return the case with all bounds, wanted changes and tolerances of its steps enlarged.

    Args:
        case: that was read from a file.
        ratio: of the new to the old ones; shares end at 1, and no step exceeds the run.
    """
    time: dict[str, Any] = dict(case.content["time"])
    for key in STEP_KEYS:
        value = getattr(case.time, key)
        if value is not None and case.time.bounds(key):
            most = 1.0 if key in SHARES else case.time.end if key.endswith("step") else None
            time[key] = ratio * value if most is None else min(ratio * value, most)
    if case.time.tolerance is not None:
        given = case.time.tolerance.model_dump(exclude_none=True)
        time["tolerance"] = {key: ratio * value for key, value in given.items()}
    return read_case(case.content | {"time": time}, case.path, "in larger steps")
