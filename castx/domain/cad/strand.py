"""A slice of a continuously cast strand: its section by the faces of a CAD part, and its mesh."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from castx.arrays import FloatArray
from castx.case.cad.mould import AXES
from castx.case.cad.strand_template import CUT, Slice
from castx.case.processes.plan import rounded
from castx.case.processes.strand import StrandSection
from castx.domain.cad.first_mesh import (
    FIRST_CELLS,
    LAST_BUDGET,
    FirstMesh,
    Say,
    as_case,
    meshed,
    part_as_it_comes,
)
from castx.domain.cad.guarded import seen_apart
from castx.domain.cad.outline import Outline
from castx.errors import CaseError, MeshError
from castx.meshes.cad.description import (
    Box,
    CadPart,
    Mould,
    Selector,
    SymmetryPlane,
    Vector,
)
from castx.meshes.cad.faces import Face

ACROSS = 60
"""Thicknesses of a slice, which has one cell along the strand, across the thickness of a section:
some five cells across the shell that leaves the mould. With 40 the walls of a square billet came to
lie 1.2 mm apart below the mould, with 64 0.6 mm: what they differ by, gap and heat make larger."""
LARGEST = 6.0
"""Largest cells over the thickness of a slice; flatter ones are poor."""
SLOW_GROWTH = 0.6
"""By how much sizes grow over a distance, from the walls of the mould inwards."""
ALONG = 1e-4
"""Component of a normal along an axis that counts as none."""
EQUAL = 1e-3
"""Relative difference of areas that counts as none."""


def _vector(place: FloatArray) -> Vector:
    x, y, z = (float(value) + 0.0 for value in place.round(6))
    return x, y, z


@dataclass(frozen=True)
class Prism:
    """A solid with the same section everywhere along an axis.

    Attributes:
        section: of it.
        box: its lowest and highest corner [m].
        outline: of its lower end.
        others: further axes along which it is a prism, as a box with sharp edges has.
    """

    section: StrandSection
    box: Box
    outline: Outline
    others: tuple[int, ...] = ()

    def places(self, thickness: float) -> dict[str, Vector]:
        """Return core, middle of a wall across each axis, and an edge, half-way up a slice [m].

        Args:
            thickness: of the slice [m].
        """
        low, high = (np.array(corner) for corner in self.box)
        axis = self.section.axis
        high[axis] = low[axis]
        middle = 0.5 * (low + high)
        walls = {f"face-{AXES[other]}": middle.copy() for other in self.section.across}
        for other, place in zip(self.section.across, walls.values(), strict=True):
            place[other] = high[other]
        found = {name: self.outline.nearest(at) for name, at in {**walls, "edge": high}.items()}
        found = {"core": self.outline.core(middle), **found}
        up = 0.5 * thickness * np.eye(3)[axis]
        return {name: _vector(place + up) for name, place in found.items()}


def new_slice(cad_file: Path, target: Path, wall: float, say: Say) -> Slice:
    """Return the slice of a strand for a new case, found by its faces and coarse meshes.

    Args:
        cad_file: with one solid, a prism along x, y or z.
        target: the case file to which its path is relative.
        wall: thickness of the mould [m].
        say: gets lines about what goes on.

    Raises:
        CaseError: the file has other solids.
        MeshError: the file cannot be read or meshed.
    """
    say(f"reading {cad_file.name}, to see its section")
    prism = strand_of(cad_file)
    section = prism.section
    if prism.others:
        axes = ", ".join(AXES[axis] for axis in prism.others)
        say(
            f"the strand is taken to run along {AXES[section.axis]}, its longest extent, but might "
            f"along {axes} too: round the edges along the strand as those of the mould, if it does"
        )
    part = _slice(cad_file, prism, wall)
    say("meshing a slice of it in its mould")
    found = _quartered(part, prism)
    quarter = found is not None
    if found is None:
        found = FirstMesh(meshed(part, LAST_BUDGET), part)
    if any(measure.name == "mould" and measure.parts > 1 for measure in found.report.bodies):
        raise CaseError(
            f"{cad_file}: the section is hollow, and a mould inside it is not known; give the "
            "section without its hole, or draw the mandrel and use another process"
        )
    file = os.path.relpath(cad_file.resolve(), target.resolve().parent)
    mould = found.part.mould
    assert mould is not None and mould.box is not None
    planes = [(plane.axis, plane.place, plane.above) for plane in found.part.symmetry]
    places = prism.places(planes[0][1] - prism.box[0][section.axis])
    case = as_case(found, file, margin=wall)
    return Slice(case, section, mould.box, tuple(planes), quarter, places)


def strand_of(cad_file: Path) -> Prism:
    """Return the prism of a CAD file.

    Raises:
        CaseError: it has several solids, or one that is no prism along x, y or z.
        MeshError: it cannot be read.
    """
    with TemporaryDirectory() as folder:
        seen = seen_apart(part_as_it_comes(cad_file), Path(folder), LAST_BUDGET)
    faces = seen.faces
    names = sorted({body for face in faces for body in face.bodies})
    if len(names) != 1:
        raise CaseError(
            f"{cad_file} has the bodies {', '.join(names)}; a strand is one solid, a short length "
            "of it, and its mould is made by castx new: export it alone"
        )
    box = _box(faces)
    found = [axis for axis in range(3) if _is_prism(faces, axis, box)]
    if not found:
        raise CaseError(
            f"{cad_file} is no prism along x, y or z; a strand is a short length of its section, "
            "extruded along an axis with flat ends: draw it so, or choose another process"
        )
    (low, high) = (np.array(corner) for corner in box)
    axis = max(found, key=lambda number: high[number] - low[number])
    lower = [
        triangles
        for face, triangles in zip(faces, seen.triangles, strict=True)
        if _is_end(face, axis, box) and face.points[0, axis] < 0.5 * (low[axis] + high[axis])
    ]
    others = tuple(other for other in found if other != axis)
    outline = Outline.of(np.concatenate(lower))
    return Prism(_section(faces, axis, box), box, outline, others)


def _box(faces: Sequence[Face]) -> Box:
    points = np.concatenate([face.points for face in faces])
    low, high = points.min(axis=0).round(9), points.max(axis=0).round(9)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _is_prism(faces: Sequence[Face], axis: int, box: Box) -> bool:
    """Return whether each face is flat across an axis at an end of the box, or runs along it."""
    return all(_is_end(face, axis, box) or _runs_along(face, axis) for face in faces)


def _is_end(face: Face, axis: int, box: Box) -> bool:
    places: FloatArray = face.points[:, axis]
    length = box[1][axis] - box[0][axis]
    return any(bool((np.abs(places - end[axis]) < 1e-6 * length).all()) for end in box)


def _runs_along(face: Face, axis: int) -> bool:
    return bool((np.abs(face.normals[:, axis]) < ALONG).all())


def _section(faces: Sequence[Face], axis: int, box: Box) -> StrandSection:
    ends = sum(face.area for face in faces if _is_end(face, axis, box))
    sides = sum(face.area for face in faces if not _is_end(face, axis, box))
    extents = [high - low for low, high in zip(*box, strict=True)]
    length = extents.pop(axis)
    return StrandSection(axis, 0.5 * ends, sides / length, (extents[0], extents[1]))


def _slice(cad_file: Path, prism: Prism, wall: float) -> CadPart:
    """Return the slice of a strand at the lower end of its part, in a tube of a wall [m]."""
    section, (low, high) = prism.section, prism.box
    length = high[section.axis] - low[section.axis]
    thickness = min(rounded(section.thickness / ACROSS), 0.5 * length)
    lowest, highest = [*low], [*high]
    for axis in section.across:
        lowest[axis], highest[axis] = low[axis] - wall, high[axis] + wall
    corners = [tuple(round(x, 7) for x in corner) for corner in (lowest, highest)]
    (a, b, c), (d, e, f) = corners
    down = [0.0, 0.0, 0.0]
    down[section.axis] = -1.0
    cut = Selector(CUT, normal=(down[0], down[1], down[2]), angle=math.radians(1.0))
    return replace(
        part_as_it_comes(cad_file), size=LARGEST * thickness, interface_size=thickness,
        growth=SLOW_GROWTH, most_cells=FIRST_CELLS, selectors=(cut,),
        mould=Mould(box=((a, b, c), (d, e, f))),
        symmetry=(SymmetryPlane(section.axis, round(low[section.axis] + thickness, 7), False),),
    )  # fmt: skip


def _quartered(part: CadPart, prism: Prism) -> FirstMesh | None:
    """Return the mesh of a quarter of a slice, if all four are alike in area and perimeter."""
    section, (low, high) = prism.section, prism.box
    thickness = part.symmetry[0].place - low[section.axis]
    first, second = section.across
    middle = [round(0.5 * (a + b), 7) for a, b in zip(low, high, strict=True)]
    kept = None
    for above in (True, False):
        planes = (
            SymmetryPlane(first, middle[first], True), SymmetryPlane(second, middle[second], above),
        )  # fmt: skip
        quarter = replace(part, symmetry=(*part.symmetry, *planes))
        try:
            report = meshed(quarter, LAST_BUDGET)
        except MeshError:  # a quarter may be empty; what is damaged is refused as a whole
            return None
        strand = next(measure for measure in report.bodies if measure.name != "mould")
        touching = sum(measure.cad for measure in report.interfaces)
        alike = _equal(4.0 * strand.cad, section.area * thickness)
        if not alike or not _equal(4.0 * touching, section.perimeter * thickness):
            return None
        kept = kept or FirstMesh(report, quarter)
    return kept


def _equal(first: float, second: float) -> bool:
    return math.isclose(first, second, rel_tol=EQUAL)
