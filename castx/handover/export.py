"""The files of `castx export`, and its messages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from castx.case.fields.feeding import EMPTIED
from castx.errors import CaseError
from castx.handover.body_state import BodyState
from castx.handover.calculix import write_calculix
from castx.handover.surfaces import (
    compensated_mould,
    distorted,
    sunk,
    write_mould_mesh,
    write_surface,
)
from castx.handover.tables import write_exaca, write_nodes
from castx.handover.target import Target
from castx.input.units import LENGTH, TIME, Dimension, number, plain_text
from castx.results.reading import Results


@dataclass(frozen=True)
class Request:
    """Request of an export; see `castx export --help`.

    Attributes:
        folder: results folder.
        to: what it is handed over as.
        output: file, for CalculiX a folder.
        body: name; None: the only body that freezes.
        time: of the fields, a text with or without unit; None: the last one.
        stage: number of the stage whose end is meant, instead of a time.
        release: without the forces that act on the body, for CalculiX.
        elastic: without yield stress, for CalculiX.
        spacing: of the grid for ExaCA, a text with or without unit.
        fit: without the rigid motion, of surfaces.
        mesh: whose nodes are moved to those of the mould.
        nominal: results folder of the part as it should be, for the mould.
    """

    folder: Path
    to: Target
    output: Path
    body: str | None = None
    time: str | None = None
    stage: int | None = None
    release: bool = False
    elastic: bool = False
    spacing: str | None = None
    fit: bool = False
    mesh: Path | None = None
    nominal: Path | None = None

    def refuse_ignored(self) -> None:
        """Refuse options that would change nothing.

        Raises:
            CaseError: with the option and what it belongs to.
        """
        of = {
            "release": (Target.CALCULIX,), "elastic": (Target.CALCULIX,),
            "spacing": (Target.EXACA,), "fit": (Target.STL, Target.MOULD),
            "mesh": (Target.MOULD,), "nominal": (Target.MOULD,),
        }  # fmt: skip
        for option, targets in of.items():
            if getattr(self, option) not in (None, False) and self.to not in targets:
                raise CaseError(f"--{option} belongs to --to {' or '.join(targets)}")


def exported(request: Request) -> list[str]:
    """Write the requested files and return messages for the user; call it on one rank only.

    Raises:
        CaseError: something that it needs is missing, or a file cannot be written.
    """
    request.refuse_ignored()
    time = None if request.time is None else _value("--time", request.time, TIME)
    results = Results(request.folder)
    state = BodyState.chosen(results, request.body, time, request.stage)
    first = f"{state.name} at {state.moment:g} s of {request.folder}"
    doubts = [f"warning: {doubt}" for doubt in results.doubts]
    return [first, *WRITERS[request.to](state, request), *doubts]


def _value(option: str, text: str, dimension: Dimension) -> float:
    try:
        value: str | float = float(text)
    except ValueError:
        value = text
    try:
        return number(value, dimension)
    except CaseError as error:
        raise CaseError(f"{option} {text}: {error}") from None


def _calculix(state: BodyState, request: Request) -> Iterator[str]:
    handed = write_calculix(state, request.output, request.release, request.elastic)
    yield from (f"written: {path}" for path in handed.files)
    classes = handed.classes
    if classes is not None:
        yield (
            f"{len(np.unique(classes.numbers))} classes of {classes.quantity}, width "
            f"{classes.width:.4g} in SI units; exact values are in {handed.files[-1].name}"
        )
    text = "left out" if request.release else "written as *CLOAD"
    yield (
        f"forces on the body, {text}: at most {handed.forces:.2g} of the largest sum of the forces "
        "of elements on a node"
    )
    if handed.over:
        place = ", ".join(f"{1e3 * x:.1f}" for x in handed.place)
        yield (
            f"warning: in {100 * handed.over:.3g} % of the elements the stress exceeds the yield "
            f"stress of *PLASTIC, {handed.excess:.3g} times at ({place}) mm: CalculiX will "
            "redistribute it; --elastic leaves *PLASTIC out"
        )


def _csv(state: BodyState, request: Request) -> Iterator[str]:
    rows = write_nodes(state, request.output)
    yield f"written: {request.output}, {rows} nodes"
    yield _front(state)


def _exaca(state: BodyState, request: Request) -> Iterator[str]:
    if request.spacing is None:
        raise CaseError('ExaCA needs the spacing of its grid: --spacing "20 um"')
    spacing = _value("--spacing", request.spacing, LENGTH)
    if spacing <= 0.0:
        raise CaseError(f"--spacing {request.spacing}: a positive length is needed")
    rows, left = write_exaca(state, request.output, spacing)
    yield f"written: {request.output}, {rows} points"
    if left:
        yield f"{left} points of the grid left out: they have no time or no cooling rate"
    yield _front(state)


def _front(state: BodyState) -> str:
    """Return when cooling rates are taken, in words."""
    at = state.results.record.get("front", "f_s = 0.9")
    return f"cooling rates, G and R are those of the moment when {at} passes"


def _stl(state: BodyState, request: Request) -> Iterator[str]:
    places, cells = sunk(state, distorted(state, request.fit))
    closed = write_surface(request.output, places, cells)
    yield f"written: {request.output}, in mm"
    yield from _pipe(state)
    if not closed:
        yield "warning: the surface is not closed"


def _pipe(state: BodyState) -> Iterator[str]:
    """Yield the sentence on the pipe of a body, which is cut out if it was written."""
    about = state.results.record.get("feeding", {}).get(state.name, {})
    volume = about.get("pipe_volume", 0.0)
    if not volume > 0.0:
        return
    text = f"the pipe of {plain_text(1e6 * volume)} cm³ at the end of the run"
    if EMPTIED in state.grid.point_data:
        yield f"{text} is cut out as far as it had sunk"
    else:
        yield f"{text} is not cut out: it needs the field {EMPTIED} in output.fields"


def _mould(state: BodyState, request: Request) -> Iterator[str]:
    nominal = None
    if request.nominal is not None:
        nominal = BodyState(Results(request.nominal), state.name)
    places = compensated_mould(state, nominal, request.fit)
    if request.output.suffix.lower() == ".msh":
        if request.mesh is None:
            raise CaseError(
                "a mesh is moved, not made: --mesh PART.msh, as castx mesh writes it, or -o *.stl"
            )
        write_mould_mesh(request.output, state, places, request.mesh)
    else:
        if request.mesh is not None:
            raise CaseError(f"--mesh makes a .msh, and {request.output} is none")
        write_surface(request.output, places, state.cells)
    yield f"written: {request.output}"
    farthest = float(np.linalg.norm(places - state.points, axis=1).max())
    yield f"the surface of the mould moves by at most {1e3 * farthest:.4g} mm"


WRITERS: Mapping[Target, Callable[[BodyState, Request], Iterator[str]]] = {
    Target.CALCULIX: _calculix,
    Target.CSV: _csv,
    Target.EXACA: _exaca,
    Target.STL: _stl,
    Target.MOULD: _mould,
}
