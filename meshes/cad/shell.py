"""A shell round the solids: of a meshed block stays what is near them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import gmsh
import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.meshes.cad.cells import TETRAHEDRON, TRIANGLE, corners_of, face_areas, node_points
from castx.meshes.cad.description import MILLIMETRES, CadPart, Mould
from castx.meshes.cad.faces import Face
from castx.meshes.cad.mould import ON_SURFACE
from castx.meshes.cad.sizes import spread
from castx.meshes.carving import Carving
from castx.meshes.linear_mesh import oriented

FINE = 0.2
"""Distance between points of the solids from which a shell is measured, in its thicknesses."""

Named = dict[str, list[Face]]


def carve_shell(
    part: CadPart,
    volumes: Mapping[int, str],
    faces: Sequence[Face],
    named: Mapping[str, Sequence[Face]],
) -> tuple[list[Face], Named]:
    """Cut the mesh of the block in the current gmsh model down to a shell round the solids.

    Args:
        part: what is meshed, with a shell.
        volumes: body of each volume.
        faces: of the bodies.
        named: faces of each surface.

    Returns:
        Faces and named surfaces; those of the block are as large as in the mesh of the shell, and
        its outer surface is a new face of each of its bodies.

    Raises:
        ValueError: nothing is left of a named surface, or of a body of the block.
    """
    assert part.mould is not None
    block = _Block.of_model(part.mould, volumes, faces)
    carving = block.carving(part)
    tags = _with_new_nodes(carving, block)
    walls = _carve_faces(carving, block, tags)
    cells, owners = _carve_volumes(carving, block, tags)
    _refuse_nothing(part.mould, block, owners)
    outer, of_cell = _outer_triangles(cells, walls)
    made = list(_add_faces(carving.points, tags, outer, block, owners[of_cell]))
    return _measured(part, faces, named, block, made)


@dataclass(frozen=True)
class _Block:
    """The mesh of a block.

    Attributes:
        volumes: its tags.
        bodies: of each of them.
        faces: tags of the faces that no other body has.
        solids: tags of the faces between the block and other bodies.
        nodes: tags of its nodes, in order.
        points: of these, (nodes, 3) [m].
        cells: corners by number of node, of each volume (cells, 4).
    """

    volumes: tuple[int, ...]
    bodies: tuple[str, ...]
    faces: tuple[int, ...]
    solids: tuple[int, ...]
    nodes: LongArray
    points: FloatArray
    cells: tuple[LongArray, ...]

    @classmethod
    def of_model(cls, mould: Mould, volumes: Mapping[int, str], faces: Sequence[Face]) -> _Block:
        """Read it from the current gmsh model."""
        own = {tag: body for tag, body in volumes.items() if body in mould.parts}
        around = {
            abs(tag) for volume in own for _, tag in gmsh.model.getBoundary([(3, volume)], False)
        }
        solids = {
            face.tag for face in faces if face.tag in around and set(face.bodies) - set(mould.parts)
        }
        corners = [corners_of(TETRAHEDRON, tag) for tag in own]
        nodes = np.unique(np.concatenate(corners))
        cells = tuple(np.searchsorted(nodes, of_volume) for of_volume in corners)
        return cls(
            tuple(own), tuple(own.values()), tuple(sorted(around - solids)), tuple(sorted(solids)),
            nodes, node_points()[nodes], cells,
        )  # fmt: skip

    def triangles(self, tag: int) -> LongArray:
        """Return the triangles of a face by number of node, (triangles, 3)."""
        return np.searchsorted(self.nodes, corners_of(TRIANGLE, tag))

    def carving(self, part: CadPart) -> Carving:
        """Return the block as the shell cuts it."""
        shell = part.shell
        assert shell is not None
        solids = np.concatenate([self.triangles(tag) for tag in self.solids])
        fixed = np.zeros(len(self.nodes), dtype=np.bool_)
        fixed[solids] = True
        corners = self.points[solids]
        step = FINE * shell
        near = np.concatenate([p for p, _ in spread(corners, np.zeros(len(corners)), step)])
        levels = distances(self.points, near, 2.0 * shell) - shell
        levels[fixed] = -shell
        return Carving(self.points, np.concatenate(self.cells), levels, self._planes(part), fixed)

    def _planes(self, part: CadPart) -> BoolArray:
        """Return on which faces of the block and planes through it each node lies."""
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        planes = [(axis, place) for box in (low, high) for axis, place in enumerate(box)]
        if part.mould is not None and part.mould.split is not None:
            planes.append(part.mould.split)
        tolerance = ON_SURFACE * float((high - low).max())
        on = [np.abs(self.points[:, axis] - place) <= tolerance for axis, place in planes]
        return np.stack(on, axis=1)


def distances(points: FloatArray, others: FloatArray, reach: float) -> FloatArray:
    """Return the distance of each point from the nearest of others, at most a reach.

    Args:
        points: (points, 3) [m].
        others: (others, 3) [m].
        reach: where it is no longer looked for [m].
    """
    lowest = np.minimum(points.min(axis=0), others.min(axis=0)) - reach
    boxes = [np.floor((where - lowest) / reach).astype(np.int64) for where in (points, others)]
    shape = np.concatenate(boxes).max(axis=0) + 2
    own, theirs = (np.ravel_multi_index(tuple(box.T), tuple(shape)) for box in boxes)
    order = np.argsort(theirs, kind="stable")
    theirs, others = theirs[order], others[order]
    rows = [np.ravel_multi_index((1 + i, 1 + j, 1), tuple(shape)) for i, j in np.ndindex(3, 3)]
    offsets = np.array(rows) - np.ravel_multi_index((2, 2, 2), tuple(shape))
    found = np.full(len(points), reach)
    members = np.argsort(own, kind="stable")
    filled, starts = np.unique(own[members], return_index=True)
    for box, here in zip(filled, np.split(members, starts[1:]), strict=True):
        firsts = np.searchsorted(theirs, box + offsets)  # of three boxes in a row
        lasts = np.searchsorted(theirs, box + offsets + 2, side="right")
        near = np.concatenate([others[a:b] for a, b in zip(firsts, lasts, strict=True)])
        if len(near):
            start = near[0]  # differences of squares lose digits far from the origin
            from_here, to_near = points[here] - start, near - start
            squares = (to_near**2).sum(axis=1) - 2.0 * from_here @ to_near.T
            least = squares.min(axis=1) + (from_here**2).sum(axis=1)
            found[here] = np.minimum(reach, np.sqrt(np.maximum(least, 0.0)))
    return found


def _with_new_nodes(carving: Carving, block: _Block) -> LongArray:
    """Move nodes of the model, add those where the shell ends, and return the tags of all."""
    points, count = MILLIMETRES * carving.points, len(block.nodes)
    for number in np.flatnonzero((carving.points[:count] != block.points).any(axis=1)):
        gmsh.model.mesh.setNode(int(block.nodes[number]), points[number], [])
    last = int(gmsh.model.mesh.getMaxNodeTag())
    new = np.arange(last + 1, last + 1 + len(points) - count)
    gmsh.model.mesh.addNodes(3, block.volumes[0], new, points[count:].ravel())
    return np.concatenate([block.nodes, new])


def _carve_faces(carving: Carving, block: _Block, tags: LongArray) -> LongArray:
    """Cut the faces of the block in the model, and return all its triangles by number of node."""
    found = [block.triangles(tag) for tag in block.solids]
    for face in block.faces:
        kept, _ = carving.kept(block.triangles(face))
        gmsh.model.mesh.removeElements(2, face)
        gmsh.model.mesh.addElementsByType(face, TRIANGLE, [], tags[kept].ravel())
        found.append(kept)
    return np.concatenate(found)


def _carve_volumes(carving: Carving, block: _Block, tags: LongArray) -> tuple[LongArray, LongArray]:
    """Cut the cells in the model, and return them by number of node with the place of a volume."""
    found, owners = [], []
    for place, (volume, cells) in enumerate(zip(block.volumes, block.cells, strict=True)):
        kept = oriented(carving.points, carving.kept(cells)[0])
        gmsh.model.mesh.removeElements(3, volume)
        gmsh.model.mesh.addElementsByType(volume, TETRAHEDRON, [], tags[kept].ravel())
        found.append(kept)
        owners.append(np.full(len(kept), place))
    return np.concatenate(found), np.concatenate(owners)


def _refuse_nothing(mould: Mould, block: _Block, owners: LongArray) -> None:
    left = {block.bodies[place] for place in np.unique(owners)}
    gone = sorted(set(block.bodies) - left)
    if gone:
        raise ValueError(
            f"nothing of {gone[0]!r} lies within mould.shell, {mould.shell:g} m, of the solids; "
            "make the shell thicker, or move mould.split"
        )


def _outer_triangles(cells: LongArray, walls: LongArray) -> tuple[LongArray, LongArray]:
    """Return the free triangles of cells without those of walls, and the cell behind each."""
    triangles = np.concatenate([cells[:, corners] for corners in combinations(range(4), 3)])
    together = np.sort(np.concatenate([triangles, walls]), axis=1)
    _, first, count = np.unique(together, axis=0, return_index=True, return_counts=True)
    outer = first[(count == 1) & (first < len(triangles))]
    return triangles[outer], outer % len(cells)


def _add_faces(
    points: FloatArray, tags: LongArray, triangles: LongArray, block: _Block, owners: LongArray
) -> Iterator[Face]:
    """Add the outer surface of each body that has one to the model, and yield it."""
    bodies = np.array(block.bodies)[owners]
    for body in dict.fromkeys(str(each) for each in bodies):
        own = triangles[bodies == body]
        tag = gmsh.model.addDiscreteEntity(2)
        gmsh.model.mesh.addElementsByType(tag, TRIANGLE, [], tags[own].ravel())
        a, b, c = np.moveaxis(points[own], 1, 0)
        vectors = 0.5 * np.cross(b - a, c - a)
        areas = np.linalg.norm(vectors, axis=1)
        centre = np.average((a + b + c) / 3.0, axis=0, weights=areas)
        normals = vectors / areas[:, None]
        yield Face(
            tag, (body,), float(areas.sum()), centre, points[own].reshape(-1, 3), normals, None
        )


def _measured(
    part: CadPart,
    faces: Sequence[Face],
    named: Mapping[str, Sequence[Face]],
    block: _Block,
    made: Sequence[Face],
) -> tuple[list[Face], Named]:
    """Return faces and named surfaces with areas of the mesh for faces of the block."""
    points = node_points()
    found = {face.tag: face for face in faces}
    for tag in found.keys() & set(block.faces):
        area = float(face_areas(points, tag).sum())
        found[tag] = replace(found[tag], area=area)
    left = [face for face in found.values() if face.area > 0.0]
    surfaces = {
        name: [found[face.tag] for face in own if found[face.tag].area > 0.0]
        for name, own in named.items()
    }
    for name, own in named.items():
        for body in {face.bodies[0] for face in own} - {face.bodies[0] for face in surfaces[name]}:
            if name != part.rest:
                raise ValueError(
                    f"surfaces: nothing of {body}/{name} is left in the shell, "
                    f"mould.shell; its outer surface is {body}/{part.rest}"
                )
    surfaces[part.rest] = [*surfaces.get(part.rest, ()), *made]
    return [*left, *made], surfaces
