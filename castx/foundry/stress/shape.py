"""The shape of a distorted body against the nominal one, after the best-fit rigid motion.

Planes of symmetry cut a body: its images beyond them take part in the fit, so that what is removed
keeps the planes where they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.domain.measures import facet_areas, nodal_sum
from castx.foundry.distortion import allowance, best_fit, normal_deviation
from castx.foundry.stress.extremes import largest, smallest
from castx.mechanics.liquid.feeding_paths import free_facets

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

ON_AXIS = 1e-9
"""Radius of a surface, beside the extent of its body, below which it is the axis."""
FLAT_SHARE = 1e-9
"""Least square of an extent over the largest one of what does not lie in one plane."""
FLAT = 1.0 - 1e-6
"""Share of the area of a surface that its area vectors sum up to, from which it is a plane."""


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane of symmetry.

    Attributes:
        normal: of length 1, (gdim,).
        offset: distance of the plane from the origin along it [m].
    """

    normal: FloatArray
    offset: float

    def image(self, points: FloatArray) -> FloatArray:
        """Return the images of points (n, gdim) [m]."""
        away = points @ self.normal - self.offset
        return np.asarray(points - 2.0 * away[:, None] * self.normal)


class Shape:
    """The surface of a body: nominal places, areas and normals of its nodes on all ranks.

    Attributes:
        known: whether it has one, and each surface of symmetry is one plane; else there is nothing
            to compare.

    Args:
        body: its mesh.
        model: geometric model; the axis of an axisymmetric body is no surface.
        fed: owned facets through which metal is fed; the others are compared, unless they lie in
            one plane.
    """

    def __init__(self, body: BodyMesh, model: str, fed: IntArray | None = None) -> None:
        self._body, self._comm, self._model = body, body.mesh.comm, model
        symmetric = body.symmetry_planes
        facets = free_facets(body, model, symmetric)
        areas, vectors = facet_areas(body, model, facets)
        if fed is not None:
            others = facet_areas(body, model, np.setdiff1d(facets, fed).astype(np.int32))
            if self._span_all_axes(others[0]):
                areas, vectors = others
        owned = body.node_numbering.owned
        self._nodes: IntArray = np.flatnonzero(areas[:owned] > 0.0).astype(np.int32)
        self._count = len(areas)
        self._points, self._numbers = self._here(body.points), self._here(body.original_nodes)
        self._areas = self._here(areas)
        planes = {
            name: plane_of(body, model, name)
            for name in symmetric
            if not is_axis(body, model, name)
        }
        self._planes = [plane for plane in planes.values() if plane is not None]
        surface = body.mesh.comm.allreduce(len(self._nodes))
        self.known = surface > 0 and len(self._planes) == len(planes)
        for name, plane in planes.items():
            if plane is None:
                continue
            nodes = body.surface_nodes(name)  # the facets of the image are there too
            vectors[nodes] -= (vectors[nodes] @ plane.normal)[:, None] * plane.normal
        vectors = self._here(vectors)
        self._normals = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)

    def _span_all_axes(self, areas: FloatArray) -> bool:
        """Return whether nodes with an area do not lie in one plane; collective.

        Args:
            areas: of the local nodes, (nodes,).
        """
        owned = slice(self._body.node_numbering.owned)
        x, weights = self._body.points[owned], areas[owned]
        sums = np.append(weights @ x, weights.sum())
        *first, total = self._comm.allreduce(sums, op=MPI.SUM)
        if not total > 0.0:
            return False
        away = x - np.array(first) / total
        if self._model == "axisymmetric":
            away[:, 0] = x[:, 0]  # the surface goes round the axis
        squares = (weights[:, None] * away).T @ away
        sizes = np.linalg.eigvalsh(self._comm.allreduce(squares, op=MPI.SUM))
        return bool(sizes[0] > FLAT_SHARE * sizes[-1])

    def _here(self, nodal: Any) -> Any:
        return nodal[self._nodes]

    def _everywhere(self, values: Any) -> Any:
        return np.concatenate(self._comm.allgather(values))

    def deviation(self, displacement: FloatArray) -> FloatArray:
        """Return the deviation of the owned surface nodes, positive outward [m]; collective.

        Args:
            displacement: of the local nodes, (nodes, gdim) [m].
        """
        places = self._points + displacement[self._nodes]
        motion = best_fit(*self._whole(places), self._model == "axisymmetric")
        return normal_deviation(self._points, motion.removed(places), self._normals)

    def allowance(self, displacement: FloatArray) -> FloatArray:
        """Return by which share the body has shrunk along the axes, (gdim,); collective.

        Args:
            displacement: of the local nodes, (nodes, gdim) [m].
        """
        nominal, places, areas = self._whole(self._points + displacement[self._nodes])
        axisymmetric = self._model == "axisymmetric"
        fitted = best_fit(nominal, places, areas, axisymmetric).removed(places)
        normals = self._everywhere(self._normals)
        for plane in self._planes:
            normals = np.concatenate([normals, Plane(plane.normal, 0.0).image(normals)])
        return allowance(nominal, fitted, normals, areas, axisymmetric)

    def _whole(self, places: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return nominal places, places and areas of all ranks and images; collective."""
        nominal, moved, areas = (
            self._everywhere(values) for values in (self._points, places, self._areas)
        )
        for plane in self._planes:
            nominal = np.concatenate([nominal, plane.image(nominal)])
            moved = np.concatenate([moved, plane.image(moved)])
            areas = np.concatenate([areas, areas])
        return nominal, moved, areas

    def nodal_deviation(self, displacement: FloatArray) -> FloatArray:
        """Return the deviation of the local nodes, not a number off the surface; collective."""
        found, known = np.zeros((2, self._count))
        found[self._nodes], known[self._nodes] = self.deviation(displacement), 1.0
        on_surface = nodal_sum(self._body, known) > 0.0
        return np.where(on_surface, nodal_sum(self._body, found), np.nan)

    def of(self, displacement: FloatArray) -> dict[str, Any]:
        """Return the distortion as JSON knows it; collective.

        Args:
            displacement: of the local nodes, (nodes, gdim) [m].

        Returns:
            Extremes of the deviation with their nominal places [m], and by which share the body has
            shrunk along the axes, None where its faces do not tell.
        """
        deviation = self.deviation(displacement)
        where = self._numbers, self._points
        shares = self.allowance(displacement)
        return {
            "outward": largest(self._comm, deviation, *where),
            "inward": smallest(self._comm, deviation, *where),
            "allowance": [None if np.isnan(share) else float(share) for share in shares],
        }


def is_axis(body: BodyMesh, model: str, name: str) -> bool:
    """Return whether a surface is the axis of an axisymmetric body, and no plane; collective.

    Args:
        body: its mesh.
        model: geometric model.
        name: of the surface.
    """
    if model != "axisymmetric":
        return False
    radii = np.abs(body.points[body.surface_nodes(name), 0])
    largest_of = (float(radii.max(initial=0.0)), float(np.abs(body.points).max(initial=0.0)))
    radius, extent = (body.mesh.comm.allreduce(own, op=MPI.MAX) for own in largest_of)
    return bool(radius <= ON_AXIS * extent)


def plane_of(body: BodyMesh, model: str, name: str) -> Plane | None:
    """Return a plane of symmetry of a body from its facets, None if it is none; collective.

    Args:
        body: its mesh.
        model: geometric model.
        name: of the surface.
    """
    facets = body.facet_tags.find(body.surface_tag(name))
    areas, vectors = facet_areas(body, model, facets)
    owned = slice(body.node_numbering.owned)
    sums = np.concatenate(
        [vectors[owned].sum(axis=0), areas[owned] @ body.points[owned], [areas[owned].sum()]]
    )
    total = np.sum(body.mesh.comm.allgather(sums), axis=0)
    dimension = body.points.shape[1]
    length = float(np.linalg.norm(total[:dimension]))
    if length < FLAT * total[-1]:
        return None
    normal = total[:dimension] / length
    return Plane(normal, float(normal @ total[dimension:-1] / total[-1]))
