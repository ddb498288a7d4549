"""Reading of a case file: values, overrides, and the checks between its parts."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from castx.case.case import STUDIES, Case
from castx.case.geometry import gravity_along
from castx.case.reading.between_parts import case_problems
from castx.case.reading.changed_keys import CHANGED_KEYS, ChangedKey, with_new_names
from castx.case.reading.freezing import with_freezing
from castx.case.reading.normals import with_normals
from castx.case.reading.stages import stage_problems
from castx.case.reading.written_out import written_out
from castx.case.skin import interface_size
from castx.errors import CaseError
from castx.input.overrides import apply_overrides, shortened
from castx.input.problems import Refusal, RefusedFile
from castx.input.toml_text import parse_toml, refuse_too_deep

_log = logging.getLogger(__name__)

_LARGEST_FILE = 4_000_000  # bytes


def load_case(source: str | Path | Mapping[str, Any], overrides: Sequence[str] = ()) -> Case:
    """Read a case from a file, or from the keys and values of one.

    >>> import castx
    >>> castx.load_case("cylinder.toml", ["time.end=10"]).time.end
    10.0
    >>> sizes = {"length": "20 mm", "width": "5 mm", "size": "1 mm"}
    >>> data = {
    ...     "geometry": {"generator": "slab", "model": "plane-strain", **sizes},
    ...     "bodies": [{"name": "casting", "material": "Al-pure", "temperature": 700}],
    ...     "time": {"end": "1 min"},
    ... }
    >>> castx.load_case(data).time.end
    60.0
    >>> castx.load_case(data, ["bodies.0.material=Al-pur"])
    Traceback (most recent call last):
    castx.input.problems.RefusedFile: case.toml --set bodies.0.material=Al-pur: ...

    Args:
        source: a TOML file as described in the contract of case files, or its content; mesh and
            field files are relative to the folder of the file, those of content to the present one.
        overrides: values that replace those of the source, such as "time.end=10".

    Raises:
        CaseError: the case cannot be read or accepted; the message shows all problems found.
    """
    changed, remark = case_data(source, overrides)
    path = Path("case.toml") if isinstance(source, Mapping) else Path(source)
    alone = {key: value for key, value in changed.items() if key not in STUDIES}
    return read_case(alone, path, remark)


def case_data(
    source: str | Path | Mapping[str, Any], overrides: Sequence[str] = ()
) -> tuple[dict[str, Any], str]:
    """Return keys and values of a case file with those that replace them, studies included.

    Args:
        source: a TOML file, or its content.
        overrides: values that replace those of the source.

    Returns:
        The content, and what messages say of the overrides.

    Raises:
        CaseError: the file cannot be read, or a path leads nowhere.
    """
    path = Path("case.toml") if isinstance(source, Mapping) else Path(source)
    data = dict(source) if isinstance(source, Mapping) else _read_file(path)
    remark = " ".join(f"--set {shortened(override)}" for override in overrides)
    changed = apply_overrides(data, overrides)
    try:
        refuse_too_deep(changed)
    except CaseError as error:
        raise CaseError(f"{path} {remark}: {error}") from None
    return changed, remark


def read_case(
    data: Mapping[str, Any],
    path: Path,
    remark: str = "",
    changed: Sequence[ChangedKey] = CHANGED_KEYS,
) -> Case:
    """Return the case described by keys and values.

    Args:
        data: content of a case file.
        path: of the case file; mesh and field files are relative to its folder.
        remark: shown behind the path in messages.
        changed: keys with new names; an old name is read for one minor version, with a warning.

    Raises:
        CaseError: the content cannot be accepted; the message shows all problems found.
    """
    source = f"{path} {remark}".strip()
    try:
        data, warnings = with_new_names(data, changed)
        case = Case.read(data)
        _refuse_contradictions(case)
    except Refusal as refusal:
        raise RefusedFile(source, refusal.problems, data) from None
    for warning in warnings:
        _log.warning("%s: %s", source, warning)
    return _sized(_completed(case, path)).with_source(path, written_out(data))


def _sized(case: Case) -> Case:
    """Return the case with a number for a size at the interface that castx has to find."""
    if not case.geometry.wants_interface_size:
        return case
    geometry = case.geometry.with_interface_size(interface_size(case))
    return case.model_copy(update={"geometry": geometry})


def _refuse_contradictions(case: Case) -> None:
    problems = [*case_problems(case), *stage_problems(case)]
    if problems:
        raise Refusal(problems)


def _completed(case: Case, path: Path) -> Case:
    """Return the case with a name, absolute paths, normals, and gravity as its model has it."""
    geometry, output = case.geometry, case.output
    if geometry.file is not None:
        file = path.resolve().parent / geometry.file
        geometry = geometry.model_copy(update={"file": file})
    if geometry.cad is not None:
        cad = geometry.cad.relative_to(path.resolve().parent)
        geometry = geometry.model_copy(update={"cad": cad})
    given = "folder" in output.model_fields_set
    folder = Path.cwd() / (output.folder if given else Path("results") / path.stem)
    gravity = gravity_along(case.loads.gravity, geometry.model)
    return case.model_copy(
        update={
            "name": case.name or path.stem,
            "interfaces": with_normals(case),
            "geometry": geometry,
            "output": output.model_copy(update={"folder": folder}),
            "measurements": tuple(m.relative_to(path.resolve().parent) for m in case.measurements),
            "loads": case.loads.model_copy(update={"gravity": gravity}),
            "bodies": tuple(
                body.model_copy(update={"temperature": body.temperature.relative_to(path)})
                for body in with_freezing(case)
            ),
        }
    )


def _read_file(path: Path) -> dict[str, Any]:
    try:
        if path.is_fifo():  # nobody may ever write into it
            raise CaseError(f"{path}: cannot be read: it is a pipe")
        with path.open("rb") as file:
            content = file.read(_LARGEST_FILE + 1)
    except OSError as error:
        raise CaseError(f"{path}: cannot be read: {error.strerror}") from None
    if len(content) > _LARGEST_FILE:
        raise CaseError(f"{path}: too large; a case file has at most {_LARGEST_FILE} bytes")
    try:
        return parse_toml(content.decode())
    except UnicodeDecodeError as error:
        raise CaseError(f"{path}: not a text file in UTF-8 (byte {error.start})") from None
    except CaseError as error:
        raise CaseError(f"{path}: {error}") from None
    except ValueError as error:
        raise CaseError(f"{path}: not a TOML file: {error}") from None
