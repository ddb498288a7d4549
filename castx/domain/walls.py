"""How many cells lie across the walls of each body of a mesh.

Behind each outer face of a body a ray goes inward along its normal, from cell to cell, until it
leaves the body. A cell counts by the length of the ray in it over its own extent along the ray, so
that layers of cells count one each, however they are cut into triangles or tetrahedra, and however
long they are along the wall. A plane of symmetry is the middle of a wall.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.domain.faces import NO_NEIGHBOUR
from castx.domain.gmsh_import import NamedMesh
from castx.domain.soundness import area_vectors
from castx.meshes.model import SYMMETRY

MOST_CELLS = 8.5
"""Cells across a wall that are counted; more are enough for all elements."""
MOST_FACES = 20000
"""Outer faces of a body from which rays go; of more each second, third … one is taken."""
BESIDE_THE_MIDDLE = (0.31, 0.36, 0.33, 0.29)
"""Weights of the corners of a face in the start of its ray, lest rays run along the edges of
regular meshes."""


@dataclass(frozen=True)
class Walls:
    """Walls of a body, looked at from samples of its outer faces.

    Args:
        areas: of the surface for which each sample stands, shape (samples,) [m²].
        cells: across the wall behind it, infinite beyond `MOST_CELLS`, shape (samples,).
        thickness: of this wall, infinite with its cells, shape (samples,) [m].
        sides: numbers of the surfaces on both sides, negative where they have none or are not
            seen, shape (samples, 2).
        surfaces: names by these numbers; faces shared with another body have its name.
    """

    areas: FloatArray
    cells: FloatArray
    thickness: FloatArray
    sides: LongArray
    surfaces: tuple[str, ...]

    def free_of(self, held: Collection[str]) -> Walls:
        """Return the walls with those that a surface bounds counted as thick.

        Args:
            held: names of these surfaces.
        """
        numbers = [index for index, name in enumerate(self.surfaces) if name in held]
        free = ~np.isin(self.sides, numbers).any(axis=1)
        return replace(
            self,
            cells=np.where(free, self.cells, np.inf),
            thickness=np.where(free, self.thickness, np.inf),
        )

    def share(self, cells: float) -> float:
        """Return the part of the surface that bounds walls with fewer cells than a number."""
        total = float(self.areas.sum())
        return float(self.areas[self.cells < cells].sum()) / total if total > 0.0 else 0.0

    def quantile(self, values: FloatArray, share: float, cells: float) -> float:
        """Return a quantile of values of the samples, by area, in walls with fewer cells.

        Args:
            values: of the samples, shape (samples,).
            share: of the area below the quantile.
            cells: that fewer lie across; some sample must have fewer.
        """
        thin = self.cells < cells
        order = np.argsort(values[thin])
        below = np.cumsum(self.areas[thin][order])
        place = int(np.searchsorted(below, share * below[-1]))
        return float(values[thin][order][min(place, len(order) - 1)])


def walls(
    mesh: NamedMesh,
    across: LongArray,
    names: LongArray,
    body_names: Sequence[str],
    axisymmetric: bool,
) -> list[Walls]:
    """Return the walls of each body.

    Args:
        mesh: all bodies on one rank.
        across: the cell across each face, (cells, faces).
        names: of the faces as numbers, (cells, faces), see `castx.domain.faces.face_names`.
        body_names: names of the bodies.
        axisymmetric: whether the mesh is turned about r = 0, in the middle of what it meets.
    """
    planes = [index for index, n in enumerate(mesh.surface_names) if n.startswith(SYMMETRY)]
    other = np.where(across == NO_NEIGHBOUR, -1, mesh.bodies[across])
    outer = other != mesh.bodies[:, None]
    middle = outer & np.isin(names, planes)
    if axisymmetric:
        middle |= outer & _on_axis(mesh)
    rays = _Rays(mesh, across, outer, middle, names)
    surfaces = (*mesh.surface_names, *body_names)
    sides = outer & ~middle
    of_bodies = [sides & (mesh.bodies == body)[:, None] for body in range(len(body_names))]
    return [
        _seen_from(rays, np.argwhere(faces), surfaces, turned=axisymmetric) for faces in of_bodies
    ]


def _on_axis(mesh: NamedMesh) -> BoolArray:
    """Return whether faces of cells lie on r = 0, shape (cells, faces)."""
    reach = np.abs(mesh.points[:, 0]).max()
    on = np.abs(mesh.points[:, 0]) <= 1e-9 * reach
    return np.asarray(on[mesh.cells[:, mesh.kind.faces]].all(axis=2))


def _seen_from(
    rays: _Rays, faces_of_cells: LongArray, surfaces: tuple[str, ...], turned: bool
) -> Walls:
    """Return the walls behind faces of cells, whose areas are 2πr times as large if turned."""
    stride = len(faces_of_cells) // MOST_FACES + 1
    cells, faces = faces_of_cells[::stride].T
    areas = stride * np.linalg.norm(rays.normals(cells, faces), axis=1)
    if turned:
        areas *= 2.0 * np.pi * rays.corners(cells, faces).mean(axis=1)[:, 0]
    return Walls(areas, *rays.shoot(cells, faces), surfaces)


class _Rays:
    """Rays through the cells of a mesh."""

    def __init__(
        self,
        mesh: NamedMesh,
        across: LongArray,
        outer: BoolArray,
        middle: BoolArray,
        names: LongArray,
    ) -> None:
        self._mesh, self._across, self._names = mesh, across, names
        self._outer, self._middle = outer, middle

    def corners(self, cells: LongArray, faces: LongArray) -> FloatArray:
        """Return the corners of faces of cells, (…, corners of a face, gdim) [m]."""
        return self._mesh.points[self._mesh.cells[cells[:, None], self._mesh.kind.faces[faces]]]

    def normals(self, cells: LongArray, faces: LongArray) -> FloatArray:
        """Return the outward normals of faces, as long as their areas, (faces, gdim) [m²]."""
        corners = self.corners(cells, faces)
        found = area_vectors(corners)
        inside = self._mesh.points[self._mesh.cells[cells]].mean(axis=1) - corners.mean(axis=1)
        found[np.einsum("fi,fi->f", found, inside) > 0.0] *= -1.0
        return found

    def shoot(
        self, cells: LongArray, faces: LongArray
    ) -> tuple[FloatArray, FloatArray, LongArray]:
        """Return cells across, thickness and surfaces of the walls behind outer faces."""
        normals = self.normals(cells, faces)
        inward = -normals / np.linalg.norm(normals, axis=1)[:, None]
        corners = self.corners(cells, faces)
        shares = np.array(BESIDE_THE_MIDDLE[: corners.shape[1]])
        starts = np.einsum("fci,c->fi", corners, shares / shares.sum())
        counts, depths = np.full(len(cells), np.inf), np.full(len(cells), np.inf)
        sides = np.column_stack([self._names[cells, faces], np.full(len(cells), -1)])
        here, going = cells.copy(), np.arange(len(cells))
        passed, depth = np.zeros(len(cells)), np.zeros(len(cells))
        while going.size:
            step, exits, extent = self._through(here, starts[going], inward[going])
            # A ray through an edge finds itself outside of the next cell: nothing is passed there.
            length = np.maximum(step - depth[going], 0.0)
            depth[going] += length
            passed[going] += length / extent
            left = self._outer[here, exits]
            ended = going[left]
            halves = np.where(self._middle[here, exits][left], 2.0, 1.0)
            sides[ended, 1] = self._names[here, exits][left]
            counts[ended], depths[ended] = halves * passed[ended], halves * depth[ended]
            here = self._across[here, exits]
            on = ~left & (passed[going] < MOST_CELLS)
            here, going = here[on], going[on]
        thick = counts >= MOST_CELLS
        counts[thick], depths[thick] = np.inf, np.inf
        return counts, depths, sides

    def _through(
        self, cells: LongArray, starts: FloatArray, along: FloatArray
    ) -> tuple[FloatArray, LongArray, FloatArray]:
        """Return where rays leave cells, by which face, and the extent of the cells along them.

        Args:
            cells: that they are in.
            starts: of the rays (rays, gdim) [m].
            along: their directions.

        Returns:
            Distance from the start [m], number of the face, extent [m].
        """
        corners = self._mesh.points[self._mesh.cells[cells]]
        extent = np.ptp(np.einsum("rci,ri->rc", corners, along), axis=1)
        distances = np.full((len(cells), len(self._mesh.kind.faces)), np.inf)
        for face in range(distances.shape[1]):
            of_face = np.full(len(cells), face)
            normals = self.normals(cells, of_face)
            slopes = np.einsum("ri,ri->r", normals, along)
            offsets = self.corners(cells, of_face).mean(axis=1) - starts
            outward = slopes > 1e-9 * np.linalg.norm(normals, axis=1)
            heights = np.einsum("ri,ri->r", normals, offsets)
            np.divide(heights, slopes, out=distances[:, face], where=outward)
        exits = np.argmin(distances, axis=1)
        return distances[np.arange(len(cells)), exits], exits, extent
