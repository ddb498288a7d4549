"""Tetrahedra in the joined solids of the current gmsh model, in named groups."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.background import mapped_cells, set_field
from castx.meshes.cad.cells import cell_qualities, solid_volumes
from castx.meshes.cad.curvature import curved_cells
from castx.meshes.cad.description import MILLIMETRES, CadPart
from castx.meshes.cad.faces import Face
from castx.meshes.cad.healing import WORST_CELL
from castx.meshes.cad.reading import centre_of, place_text
from castx.meshes.cad.sizes import (
    Samples,
    SizeGrid,
    crowded_cells,
    estimated_cells,
    samples_of,
    size_grid,
    wanted_sizes,
)

FRONTAL, MESHADAPT = 6, 1
"""gmsh's numbers of the algorithms on faces: good cells, and cells that cross each other less."""
DELAUNAY, HXT = 1, 10
"""gmsh's numbers of the algorithms in solids."""

REMOVED = 4.0
"""Tolerance that is proposed over the radius of an edge: a quarter of its circle is 1.6 wide."""


def generate(
    part: CadPart,
    volumes: Mapping[int, str],
    faces: Sequence[Face],
    named: Mapping[str, Sequence[Face]],
    scratch: str,
) -> None:
    """Mesh the current gmsh model.

    Args:
        part: what is meshed.
        volumes: body of each volume.
        faces: of the bodies.
        named: faces of each surface.
        scratch: a file to write sizes into.

    Raises:
        ValueError: gmsh finds no mesh, with the place; or it would have too many cells.
    """
    size = part.size * MILLIMETRES
    # Without sizes at its points gmsh takes a tenth of the extent.
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", part.curvature)
    gmsh.option.setNumber("Mesh.Algorithm", FRONTAL)
    gmsh.option.setNumber("Mesh.Optimize", 1)
    _refuse_small_faces(part, *curved_cells(part, faces))
    _mesh_faces()
    samples = samples_of(faces)
    wishes = wanted_sizes(part, faces, named, samples)
    grid = size_grid(part, wishes)
    _refuse_crowds(part, samples, wishes.sizes[: len(samples.areas)], grid)
    _refuse_many(part, samples, wishes.sizes[: len(samples.areas)], volumes)
    _refuse_fine_map(part)
    set_field(part, grid, volumes, scratch)
    _mesh_all()


def _mesh_all() -> None:
    """Mesh faces and solids, with other cells on the faces if no solid has room for its own."""
    failures = []
    for algorithm in (FRONTAL, MESHADAPT):
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.Algorithm", algorithm)
        _mesh_faces()
        failure = _mesh_solids()
        if not failure:
            return
        failures.append(failure)
    raise ValueError(f"gmsh cannot mesh the solids: {failures[0]}; {CURE}")


def _mesh_faces() -> None:
    failure = _failure_of(2)
    if failure:
        raise ValueError(f"gmsh cannot mesh the faces: {failure}{_place()}; {CURE}")


def _failure_of(dim: int) -> str:
    """Mesh up to a dimension and return what gmsh says that went wrong, nothing if all is well."""
    # After an exception gmsh takes itself for busy, and leaves all later meshing undone.
    gmsh.option.setNumber("General.AbortOnError", 1)
    try:
        gmsh.model.mesh.generate(dim)
    finally:
        gmsh.option.setNumber("General.AbortOnError", 2)
    return str(gmsh.logger.getLastError())


def _refuse_many(
    part: CadPart, samples: Samples, sizes: FloatArray, volumes: Mapping[int, str]
) -> None:
    drawn = {body: volume for body, (_, volume) in solid_volumes(volumes).items()}
    cells = estimated_cells(part, samples, sizes, drawn)
    if cells > part.most_cells:
        factor = (1.2 * cells / part.most_cells) ** (1.0 / 3.0)
        raise ValueError(
            f"about {cells:.1e} cells, and geometry.most_cells allows {part.most_cells:.1e}; make "
            f"all sizes {factor:.2g} times as large, geometry.across or geometry.curvature "
            "smaller, or geometry.growth larger"
        )


def _refuse_fine_map(part: CadPart) -> None:
    cells = 0.0 if part.size_map is None else mapped_cells(part.size_map, part.size)
    if cells > part.most_cells:
        raise ValueError(
            f"geometry.size_map asks for about {cells:.1e} cells, and geometry.most_cells allows "
            f"{part.most_cells:.1e}; allow more, or make fewer rounds of --adapt"
        )


def _refuse_crowds(part: CadPart, samples: Samples, sizes: FloatArray, grid: SizeGrid) -> None:
    """Refuse a wall or a sharp wedge so thin that it alone needs too many cells, with its place."""
    cells = crowded_cells(grid)
    if cells > part.most_cells:
        least = int(np.argmin(sizes))
        raise ValueError(
            f"about {cells:.1e} cells, and geometry.most_cells allows {part.most_cells:.1e}: round "
            f"{place_text(samples.points[least])} a wall, a wedge or a curved face asks for a size "
            f"of {sizes[least]:.2g} m; thicken it or round it off in CAD, allow more cells, or "
            "take walls as they come, geometry.across = 0"
        )


def _refuse_small_faces(part: CadPart, cells: float, size: float, place: FloatArray) -> None:
    """Refuse rounded edges so small that they alone need too many cells, with a place and a cure.

    Args:
        part: what is meshed.
        cells: that curved faces ask for.
        size: the smallest one of them [m].
        place: of it [m].
    """
    if cells > part.most_cells:
        radius = size * part.curvature / (2.0 * pi)
        raise ValueError(
            f"about {cells:.1e} cells, and geometry.most_cells allows {part.most_cells:.1e}: round "
            f"{place_text(place)} a face with a radius of {radius:.2g} m asks for a size of "
            f"{size:.2g} m; remove faces that are so narrow, geometry.tolerance = "
            f"{REMOVED * radius:.1g}, or allow fewer cells round a circle, geometry.curvature"
        )


def _mesh_solids() -> str:
    """Mesh the solids and return why that has failed, nothing if it has not."""
    failure = ""
    for algorithm in (HXT, DELAUNAY):  # the faster one, and the one that says more
        gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
        said = _failure_of(3)
        empty = _without_cells()
        # now and then one leaves a flat cell where the other leaves none
        sound = not said and not empty
        if sound and (algorithm == DELAUNAY or _worst_quality() >= WORST_CELL):
            return ""
        if said:
            failure = f"{said}{_place()}"
        elif empty:
            failure = f"no cells round {place_text(centre_of(3, empty[0]))}"
        gmsh.model.mesh.clear(gmsh.model.getEntities(3))
    return failure


def _worst_quality() -> float:
    volumes = [tag for _, tag in gmsh.model.getEntities(3)]
    return float(cell_qualities(volumes)[1].min())


CURE = (
    "the faces there may intersect themselves or each other: repair the part in CAD, choose a "
    "smaller size, or another geometry.tolerance"
)


def _without_cells() -> list[int]:
    volumes = gmsh.model.getEntities(3)
    return [tag for _, tag in volumes if not gmsh.model.mesh.getElements(3, tag)[0].size]


def _place() -> str:
    """Return where gmsh has failed, if it says so."""
    points = []
    for dim, tag in gmsh.model.mesh.getLastEntityError():
        box = np.reshape(gmsh.model.getBoundingBox(dim, tag), (2, 3))
        points.append(box.mean(axis=0))
    for tag in gmsh.model.mesh.getLastNodeError():
        points.append(np.array(gmsh.model.mesh.getNode(tag)[0]))
    return f", round {place_text(points[0] / MILLIMETRES)}" if points else ""


def add_groups(volumes: Mapping[int, str], named: Mapping[str, Sequence[Face]]) -> None:
    """Name bodies and surfaces as the physical groups of the current gmsh model.

    Args:
        volumes: body of each volume.
        named: faces of each surface.
    """
    for dim, tag in gmsh.model.getPhysicalGroups():  # whose names would stay with their numbers
        gmsh.model.removePhysicalName(gmsh.model.getPhysicalName(dim, tag))
    gmsh.model.removePhysicalGroups()
    for body in dict.fromkeys(volumes.values()):
        tags = [tag for tag, owner in volumes.items() if owner == body]
        gmsh.model.addPhysicalGroup(3, tags, name=body)
    for name, faces in named.items():
        gmsh.model.addPhysicalGroup(2, [face.tag for face in faces], name=name)


def write(file: str) -> None:
    """Write the mesh of the named groups in metres, every digit of it."""
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.option.setNumber("Mesh.SaveAll", 0)
    gmsh.option.setNumber("Mesh.ScalingFactor", 1.0 / MILLIMETRES)
    gmsh.write(file)
