"""Sizes of cells as gmsh takes them: the least of several fields over space."""

from __future__ import annotations

from collections.abc import Mapping

import gmsh
import numpy as np

from castx.meshes.cad.cells import tetrahedron_volumes
from castx.meshes.cad.curvature import FILLING
from castx.meshes.cad.description import MILLIMETRES, CadPart, SizeMap
from castx.meshes.cad.sizes import SizeGrid

NO_SIZE = 1e22
"""What gmsh takes for no size."""


def set_field(part: CadPart, grid: SizeGrid, volumes: Mapping[int, str], scratch: str) -> None:
    """Give gmsh the least of all sizes as its background field.

    Args:
        part: what is meshed.
        grid: of sizes.
        volumes: body of each volume.
        scratch: a file to write.
    """
    field = gmsh.model.mesh.field
    grid.write(scratch)
    structured = field.add("Structured")
    field.setString(structured, "FileName", scratch)
    field.setNumber(structured, "TextFormat", 0)
    fields = [structured]
    if part.size_map is not None:
        fields.append(_size_map_field(part.size_map))
    for rule in part.rules:
        if rule.body is not None:
            fields.append(field.add("Constant"))
            inside = [volume for volume, body in volumes.items() if body == rule.body]
            field.setNumbers(fields[-1], "VolumesList", inside)
            field.setNumber(fields[-1], "VIn", rule.size * MILLIMETRES)
            field.setNumber(fields[-1], "VOut", NO_SIZE)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", fields)
    field.setAsBackgroundMesh(least)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)


def _size_map_field(size_map: SizeMap) -> int:
    """Give gmsh a field with these sizes, and return its tag; outside, the nearest one holds."""
    rows = np.concatenate(
        [np.swapaxes(size_map.corners, 1, 2).reshape(-1, 12), size_map.sizes], axis=1
    )
    view = gmsh.view.add("sizes")
    gmsh.view.addListData(view, "SS", len(rows), (MILLIMETRES * rows).ravel())
    field = int(gmsh.model.mesh.field.add("PostView"))
    gmsh.model.mesh.field.setNumber(field, "ViewTag", view)
    return field


def mapped_cells(size_map: SizeMap, largest: float) -> float:
    """Return the estimated number of cells of a mesh with these sizes.

    Args:
        size_map: the sizes.
        largest: size of cells where the map allows larger ones [m].
    """
    volumes = tetrahedron_volumes(size_map.corners)
    sizes = np.minimum(size_map.sizes, largest).mean(axis=1)
    return float(np.sum(volumes / (FILLING * sizes**3)))
