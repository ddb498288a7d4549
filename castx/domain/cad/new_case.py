"""A first case file for a CAD part, from a coarse mesh of it."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from castx.case.cad.geometry import SUFFIXES, is_cad_file
from castx.case.cad.template import NewCase, case_text
from castx.domain.cad.guarded import meshed_apart
from castx.errors import CaseError, MeshError
from castx.meshes.cad.description import CadFile, CadPart, Mould
from castx.meshes.cad.report import Report

MARGIN = 0.25
"""Thickness of the mould round a lone solid, in extents of the solid."""
FIRST_CELLS = 1e5
"""Cells of a first mesh, with which a step takes seconds; thin walls alone may ask for more."""


def write_new_case(cad_file: Path, target: Path) -> None:
    """Write a case file for a CAD file; call it on one rank only.

    Args:
        cad_file: with solids.
        target: the case file, which must not exist.

    Raises:
        CaseError: the file is no CAD file, or the case file exists or cannot be written.
        MeshError: the CAD file cannot be meshed.
    """
    if not is_cad_file(cad_file):
        raise CaseError(f"{cad_file}: a CAD file is needed: {', '.join(SUFFIXES)}")
    if target.exists():
        raise CaseError(f"{target} exists; give another one with --output, or remove it")
    text = case_text(new_case(cad_file, target))
    try:
        target.write_text(text)
    except OSError as error:
        raise CaseError(f"cannot write {target}: {error.strerror}") from None


def new_case(cad_file: Path, target: Path) -> NewCase:
    """Return the data of a new case, found by a coarse mesh of a CAD file.

    Args:
        cad_file: with solids; a lone one gets a mould.
        target: the case file to which its path is relative.
    """
    (report, across), margin = _survey(cad_file, None), None
    if len(report.bodies) == 1:
        margin = _rounded(MARGIN * report.extent)
        report, across = _survey(cad_file, Mould(margin=margin))
    file = os.path.relpath(cad_file.resolve(), target.resolve().parent)
    between = [(measure.name.split("/"), measure.cad) for measure in report.interfaces]
    return NewCase(
        file,
        _rounded(report.size),
        margin,
        tuple((measure.name, measure.cad) for measure in report.bodies),
        tuple((bodies[0], bodies[1], area) for bodies, area in between),
        tuple((measure.name, measure.cad) for measure in report.surfaces),
        across,
    )


def _survey(cad_file: Path, mould: Mould | None) -> tuple[Report, int]:
    """Return the report of a coarse mesh and its cells across walls: one, or none if refused."""
    part = CadPart((CadFile(str(cad_file)),), math.inf, across=0, curvature=8.0, mould=mould)
    with TemporaryDirectory() as folder:
        mesh = Path(folder) / "mesh.msh"
        try:
            return meshed_apart(replace(part, across=1, most_cells=FIRST_CELLS), mesh), 1
        except MeshError:  # too many or flat cells in thin walls; what is damaged is refused again
            return meshed_apart(part, mesh), 0


def _rounded(length: float) -> float:
    """Return a length with two digits [m]."""
    return float(f"{length:.2g}")
