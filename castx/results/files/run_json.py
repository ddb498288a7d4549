"""The shape of run.json, checked before anything relies on it: users edit and merge such files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from castx.errors import CaseError
from castx.input.problems import dotted

LARGEST = 64 * 1024**2
"""Bytes of a record that is still read."""


class _Strict(BaseModel):
    model_config = ConfigDict(strict=True, defer_build=True)


_Time = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
_Model = Literal["plane-stress", "plane-strain", "generalised-plane-strain", "axisymmetric", "3d"]


class _Totals(_Strict):
    steps: int = 0
    heat_iterations: int = 0
    mechanics_iterations: int = 0
    linear_iterations: int = 0
    contact_changes: int = 0
    passes: int = 0
    cutbacks: int = 0
    repeats: int = 0
    frozen_pairs: int = 0
    unbalanced: int = 0
    fallbacks: int = 0


class _Case(_Strict):
    name: str = ""
    file: str = ""
    digest: str = ""


class _Plane(_Strict):
    normal: Annotated[list[float], Field(min_length=2, max_length=3)]
    offset: float = 0.0


class _Tearing(_Strict):
    kou: float = 0.0
    clyne_davies: float | None = None


class _Coherency(_Strict):
    value: float = 0.0
    source: str = ""


class _ThinWalls(_Strict):
    body: str = ""
    cells: str = ""
    formulation: str = ""
    one: float = 0.0
    two: float = 0.0
    few: float = 0.0
    thinnest: float = 0.0
    thickest: float = 0.0
    across: float = 0.0
    error: float | None = None
    error_if_fine: float | None = None
    freezing_error: list[float] | None = None
    freezing_error_if_fine: list[float] | None = None


class _Body(_Strict):
    material: str = ""
    law: str = ""
    temperature: str = ""
    freezes: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    coherency: _Coherency | None = None
    tearing: _Tearing | None = None
    nodes: int = 0
    cells: int = 0
    symmetry: list[_Plane] = []
    thin_walls: _ThinWalls | None = None


class _Interface(_Strict):
    pairs: int = 0
    contact: str = ""
    heat: str | None = None


class _Exit(_Strict):
    reason: str = ""
    message: str = ""


class _Event(_Strict):
    time: _Time = 0.0
    cycle: int = 1
    stage: int = 0
    bodies: list[str] = []
    ejection: dict[str, dict[str, float]] = {}
    change: float | None = None
    periodic: bool = False


class _HotSpot(_Strict):
    body: str = ""
    pool: int = 1
    parent: int | None = None
    children: list[int] = []
    merged: list[int] = []
    isolated: float = 0.0
    ended: float | None = None
    place: list[float] = []
    centre: list[float] = []
    volume: float = 0.0
    deficit: float | None = None


class _Extreme(_Strict):
    value: float = 0.0
    place: list[float] = []


class _StressExtremes(_Strict):
    largest_principal: _Extreme = _Extreme()
    smallest_principal: _Extreme = _Extreme()
    von_mises: _Extreme = _Extreme()
    mean_von_mises: float = 0.0


class _Distortion(_Strict):
    outward: _Extreme = _Extreme()
    inward: _Extreme = _Extreme()
    allowance: list[float | None] = []


class _MeshError(_Strict):
    error: float = 0.0
    size: float = 0.0
    relative: float = 0.0


class _SolidBody(_Strict):
    stress: _StressExtremes = _StressExtremes()
    hindered: bool = False
    stress_error: _MeshError | None = None
    distortion: _Distortion | None = None
    flatness: dict[str, float] = {}
    roundness: dict[str, float] = {}


class _StageEnd(_Strict):
    stage: int = 0
    cycle: int = 1
    time: _Time = 0.0
    bodies: dict[str, _SolidBody] = {}


class _Feeding(_Strict):
    pipe_volume: float = 0.0
    unfed_volume: float = 0.0
    levels: dict[str, float | None] = {}


class _Opening(_Strict):
    first: float | None = None
    opened_fraction: float = 0.0


class _Ejection(_Strict):
    stage: int = 0
    cycle: int = 1
    time: _Time = 0.0
    forces: dict[str, float] = {}


class _Record(_Strict):
    castx: str = ""
    versions: dict[str, str] = {}
    case: _Case = _Case()
    model: _Model | None = None
    scheme: str = ""
    end: _Time = 0.0
    bodies: dict[str, _Body] = {}
    interfaces: dict[str, _Interface] = {}
    ranks: int = 1
    started: str = ""
    written: str = ""
    time_reached: _Time = 0.0
    totals: _Totals = _Totals()
    process: list[_Event] = []
    hot_spots: list[_HotSpot] = []
    stage_ends: list[_StageEnd] = []
    feeding: dict[str, _Feeding] = {}
    openings: dict[str, _Opening] = {}
    ejection: list[_Ejection] = []
    flux_errors: dict[str, _MeshError] = {}
    feeding_distance: dict[str, float | None] = {}
    wall: float = 0.0
    peak_memory: dict[str, int] = {}
    exit: _Exit = _Exit()


def read_record(path: Path) -> dict[str, Any]:
    """Return the record of a run as it stands in its file.

    Raises:
        CaseError: it cannot be read or is no record of castx; with the place and what is needed.
    """
    try:
        if not path.is_file():
            raise CaseError(f"there is no file {path}")
        if path.stat().st_size > LARGEST:
            raise CaseError(f"{path}: larger than {LARGEST / 1024**2:g} MiB")
        record = json.loads(path.read_text(encoding="utf-8"))
        _refuse_strangers(path, _Record.model_validate(record))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = dotted(tuple(first["loc"])) or "its content"
        raise CaseError(f"{path} is no record of a run: {where}: {first['msg']}") from None
    except (OSError, RecursionError) as error:
        raise CaseError(f"{path} cannot be read: {error}") from None
    except CaseError:
        raise
    except ValueError as error:
        raise CaseError(f"{path} is no record of a run: {error}") from None
    found: dict[str, Any] = record
    return found


def _refuse_strangers(path: Path, record: _Record) -> None:
    """Refuse bodies that a record speaks of and does not list.

    Raises:
        CaseError: with the body, its place and the bodies that are listed.
    """
    named = [
        (f"interfaces.{pair!r}", body) for pair in record.interfaces for body in pair.split("/")
    ]
    named += [
        (f"stage_ends[{number}].bodies", body)
        for number, end in enumerate(record.stage_ends)
        for body in end.bodies
    ]
    named += [
        (f"hot_spots[{number}].body", spot.body) for number, spot in enumerate(record.hot_spots)
    ]
    named += [("feeding", body) for body in record.feeding]
    for place, body in named if record.bodies else ():
        if body not in record.bodies:
            raise CaseError(
                f"{path} is no record of a run: {place}: {body!r} is no body of it "
                f"({', '.join(record.bodies)}); put a whole copy in its place"
            )


def completed(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return a record of `read_record` with the usual values of what it leaves out."""
    known: dict[str, Any] = _with_rest(record, _Record.model_validate(record).model_dump())
    return known


def number_of_cells(record: Mapping[str, Any]) -> int:
    """Return the number of cells of all bodies of a run; those of unknown number count for none."""
    return sum(int(body.get("cells", 0)) for body in record["bodies"].values())


def _with_rest(whole: Any, known: Any) -> Any:
    """Return known entries with those of a record that are not known."""
    if isinstance(whole, Mapping) and isinstance(known, dict):
        return {**whole} | {
            key: _with_rest(whole[key], value) if key in whole else value
            for key, value in known.items()
        }
    if isinstance(whole, list) and isinstance(known, list):
        return [_with_rest(*pair) for pair in zip(whole, known, strict=True)]
    return known
