"""From CAD files to the file of a mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite

import numpy as np

from castx.meshes.cad.assembly import join, refuse_other_bodies
from castx.meshes.cad.cells import Quality, cell_qualities, quality_of, solid_volumes
from castx.meshes.cad.description import CadPart, NoCellsError
from castx.meshes.cad.faces import Face, faces_of
from castx.meshes.cad.healing import mend, refuse_flat_cells, refuse_small
from castx.meshes.cad.meshing import add_groups, generate, write
from castx.meshes.cad.mould import CHANNEL, extents, named_by_making, whole_halves, with_mould
from castx.meshes.cad.narrow import refuse_narrow_faces, without_narrow_faces
from castx.meshes.cad.reading import place_text, read_solids
from castx.meshes.cad.report import Report, report_of
from castx.meshes.cad.selection import named_faces
from castx.meshes.cad.shell import carve_shell

COARSE = 12
"""Cells along the longest extent where no size is given."""
USUAL = (1e-3, 10.0)
"""Extents of parts that nobody wonders about [m]: millimetres read as metres make others."""
SLOW_CELL = 0.01
"""Quality of the worst cell below which a run may take long."""


def mesh_part(part: CadPart, file: str) -> Report:
    """Mesh an assembly in the current, empty gmsh model, and write its mesh in metres.

    Args:
        part: the assembly.
        file: the gmsh file to write, .msh.

    Raises:
        ValueError: a file, a name, a selector or a solid makes no mesh.
        NoCellsError: sound solids make none of the sizes that are wanted.
    """
    solids = read_solids(part.files, part.names, f"{file}.brep")
    solids, left_out = without_narrow_faces(solids, part.narrowest)
    solids, remarks = mend(solids, part.tolerance)
    solids = with_mould(part, solids)
    drawn = solid_volumes({solid.tag: solid.name for solid in solids if solid.rank != CHANNEL})
    extent = float(np.ptp(extents([solid.tag for solid in solids]), axis=0).max())
    if not isfinite(part.size):
        part = replace(part, size=extent / COARSE)
    drills = [solid.tag for solid in solids if solid.rank == CHANNEL]
    volumes, given = whole_halves(join(solids, part.tolerance, drills), part.mould)
    refuse_other_bodies(part.bodies, volumes, solids)
    if part.mould is not None:  # what is cut out of a body is not missing
        drawn = solid_volumes(volumes)
    faces = faces_of(volumes)
    named = _named(part, faces, list(dict.fromkeys(volumes.values())))
    add_groups(volumes, named)  # with which gmsh makes other cells than without
    try:
        quality, faces, named = _meshed(part, volumes, faces, named, f"{file}.sizes")
    except ValueError as error:
        raise NoCellsError(str(error)) from None
    told = [*left_out, *remarks, *given, *unusual_size(extent), *nearly_flat(quality)]
    carved = () if part.mould is None or part.shell is None else part.mould.parts
    report = report_of(volumes, drawn, faces, named, quality, told, carved)
    write(file)
    return replace(report, extent=extent, size=part.size)


def _meshed(
    part: CadPart,
    volumes: Mapping[int, str],
    faces: Sequence[Face],
    named: Mapping[str, Sequence[Face]],
    scratch: str,
) -> tuple[Quality, list[Face], dict[str, list[Face]]]:
    """Mesh joined solids, and return the quality of the cells, faces and named surfaces."""
    tags = list(volumes)
    refuse_small(tags, part.tolerance)
    refuse_narrow_faces(part, tags)
    generate(part, volumes, faces, named, scratch)
    left, surfaces = list(faces), {name: list(own) for name, own in named.items()}
    if part.shell is not None:
        left, surfaces = carve_shell(part, volumes, faces, named)
        add_groups(volumes, surfaces)
    corners, qualities = cell_qualities(tags)
    refuse_flat_cells(tags, corners.mean(axis=1), qualities)
    return quality_of(corners, qualities), left, surfaces


def unusual_size(extent: float) -> Iterator[str]:
    """Yield a remark if a part is so long or so short that its unit may be mistaken [m]."""
    if not USUAL[0] <= extent <= USUAL[1]:
        yield (
            f"the longest extent of the solids is {extent:.3g} m, while castings have {USUAL[0]:g} "
            f"to {USUAL[1]:g} m: if that is wrong, export them from CAD in the right unit"
        )


def nearly_flat(quality: Quality) -> Iterator[str]:
    """Yield a remark if the worst cell is so flat that a run may take long."""
    if quality.worst < SLOW_CELL:
        yield (
            f"the worst cell, at {place_text(np.array(quality.place))}, has a quality of "
            f"{quality.worst:.2g}, and below {SLOW_CELL:g} a run may take many more iterations: if "
            "grooves, a thread or slivers make it, geometry.narrowest above the width of their "
            "faces leaves them out, and geometry.tolerance mends slivers"
        )


def _named(part: CadPart, faces: Sequence[Face], bodies: Sequence[str]) -> dict[str, list[Face]]:
    """Return the faces of the named surfaces; selectors go after names of the construction."""
    made = named_by_making(part, faces)
    taken = {face.tag for group in made.values() for face in group}
    left = [face for face in faces if face.tag not in taken]
    chosen = named_faces(part.selectors, left, bodies, part.rest)
    return {name: [*made.get(name, ()), *chosen.get(name, ())] for name in {**made, **chosen}}
