"""A first case file for a CAD part, from a coarse mesh of it."""

from __future__ import annotations

import math
import os
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from scipy.optimize import brentq

from castx.case.cad.geometry import SUFFIXES, CadGeometry, is_cad_file
from castx.case.cad.template import NewCase, case_text
from castx.case.reading.read import load_case
from castx.case.skin import MOST_GROWTH, skins
from castx.domain.cad.guarded import meshed_apart
from castx.errors import CaseError, MeshError
from castx.input.toml_text import parse_toml
from castx.meshes.cad.description import CadFile, CadPart, Mould
from castx.meshes.cad.report import Report

MARGIN = 0.25
"""Thickness of the mould round a lone solid, in extents of the solid."""
GROWTH: float = CadGeometry.model_fields["growth"].default
"""By how much sizes grow over a distance if a case says nothing else."""
EDGES = 1.3
"""What edges of interfaces and the changes between sizes add to the cells of plane layers."""
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
    text = case_text(with_interface_size(new_case(cad_file, target)))
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


def with_interface_size(case: NewCase) -> NewCase:
    """Return a new case with cells that resolve its skins, if they have to be finer for that.

    The number of cells grows at most to `MOST_GROWTH` of what the largest size alone would make.
    """
    areas: dict[str, float] = defaultdict(float)
    for first, second, area in case.interfaces:
        areas[first] += area
        areas[second] += area
    for on, area in case.surfaces:
        areas[on.partition("/")[0]] += area
    moduli = {body: v / areas[body] for body, v in case.bodies if areas[body] > 0.0}
    foreseen = skins(load_case(parse_toml(case_text(case))), moduli)
    wanted = min((skin.proposal for skin in foreseen), default=case.size)
    size = max(wanted, _finest(case))
    return replace(case, interface_size=_rounded(size)) if size < case.size else case


def _finest(case: NewCase) -> float:
    """Return the size at interfaces with which a mesh has as many cells as it may [m]."""
    least = sum(volume for _, volume in case.bodies) / case.size**3
    area = 2.0 * sum(area for *_, area in case.interfaces)  # both sides

    def excess(size: float) -> float:
        layers = 0.5 * (size**-2 - case.size**-2) - (case.size - size) / case.size**3
        return EDGES * area * layers / GROWTH - (MOST_GROWTH[3] - 1.0) * least

    least_size = 1e-3 * case.size
    if excess(least_size) <= 0.0:
        return least_size
    return float(brentq(excess, least_size, case.size, xtol=1e-3 * case.size))


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
