"""Measures of cells and surfaces of a body, and the volumes and areas of its nodes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from mpi4py import MPI

import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la
from dolfinx.common import IndexMap
from dolfinx.mesh import Mesh, MeshTags, meshtags

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.cell_kinds import linear_means
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics
from castx.forms.nodal import nodal_area_vector, nodal_measure


def cell_measure(body: BodyMesh, model: str, degree: int | None) -> kinematics.WeightedMeasure:
    """Return the weighted measure of the cells of a body, exact for a polynomial degree.

    Args:
        body: mesh of the body.
        model: geometric model.
        degree: of the polynomial; None: as UFL estimates it for each integrand.
    """
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    metadata = {} if degree is None else {"quadrature_degree": degree}
    measure = ufl.Measure("dx", domain=body.mesh, metadata=metadata)
    return kinematics.WeightedMeasure(weight, measure)


class SurfaceMeasures:
    """The weighted measures of some surfaces of a body.

    Forms name their surfaces by number, and are compiled anew for other numbers. Counted among
    these surfaces alone they are the same on all meshes.

    Args:
        body: mesh of the body.
        model: geometric model.
        surfaces: their names, each as often as one likes.

    Raises:
        MeshError: the body has no such surface.
    """

    def __init__(self, body: BodyMesh, model: str, surfaces: Iterable[str]) -> None:
        self._mesh = body.mesh
        self._weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
        # In the order of their tags, in which integrals are added up.
        ordered = sorted(set(surfaces), key=body.surface_tag)
        self._numbers = {name: number for number, name in enumerate(ordered, 1)}
        facets = [body.facet_tags.find(body.surface_tag(name)) for name in ordered]
        self._tags = numbered_facets(body.mesh, facets)

    def __call__(self, surface: str, degree: int | None) -> kinematics.WeightedMeasure:
        """Return the measure of a surface, exact for a polynomial degree.

        Args:
            surface: its name.
            degree: of the polynomial; None: as UFL estimates it for each integrand.
        """
        measure = ufl.Measure(
            "ds",
            domain=self._mesh,
            subdomain_data=self._tags,
            subdomain_id=self._numbers[surface],
            metadata={} if degree is None else {"quadrature_degree": degree},
        )
        return kinematics.WeightedMeasure(self._weight, measure)


def numbered_facets(mesh: Mesh, parts: Sequence[npt.NDArray[np.int32]]) -> MeshTags:
    """Return outer facets of this rank with the numbers of their parts, from 1 on."""
    facets = np.concatenate([np.zeros(0, dtype=np.int32), *parts])
    numbers = np.repeat(np.arange(1, len(parts) + 1, dtype=np.int32), [len(p) for p in parts])
    order = np.argsort(facets, kind="stable")
    return meshtags(mesh, mesh.topology.dim - 1, facets[order], numbers[order])


def nodal_volumes(body: BodyMesh, model: str, degree: int | None = 2) -> FloatArray:
    """Return the volumes of the owned nodes of a body [m³], shape (owned,).

    Args:
        body: mesh of the body.
        model: geometric model.
        degree: of the quadrature; None: as UFL estimates it.
    """
    dx = cell_measure(body, model, degree)
    volumes = _assembled(nodal_measure(ufl.TestFunction(body.nodes), dx.weight, dx.measure))
    return volumes[: body.nodes.dofmap.index_map.size_local]


def nodal_areas(body: BodyMesh, model: str, surface: str, degree: int | None = None) -> FloatArray:
    """Return the areas ∫ φ dS of the local nodes of a body on a surface [m²], shape (nodes,).

    Args:
        body: mesh of the body.
        model: geometric model.
        surface: name of the surface.
        degree: of the quadrature; None: as UFL estimates it.

    Raises:
        MeshError: the body has no such surface.
    """
    ds = SurfaceMeasures(body, model, [surface])(surface, degree)
    return _assembled(nodal_measure(ufl.TestFunction(body.nodes), ds.weight, ds.measure))


def nodal_area_vectors(
    body: BodyMesh, model: str, surface: str, degree: int | None = None
) -> FloatArray:
    """Return ∫ φ n dS of the local nodes on a surface, n outward [m²], shape (nodes, gdim).

    Args:
        body: mesh of the body.
        model: geometric model.
        surface: name of the surface.
        degree: of the quadrature; None: as UFL estimates it.

    Raises:
        MeshError: the body has no such surface.
    """
    gdim = body.mesh.geometry.dim
    ds = SurfaceMeasures(body, model, [surface])(surface, degree)
    v = ufl.TestFunction(body.vectors)
    normal = ufl.FacetNormal(body.mesh)
    return _assembled(nodal_area_vector(v, normal, ds.weight, ds.measure)).reshape(-1, gdim)


def facet_areas(
    body: BodyMesh, model: str, facets: npt.NDArray[np.int32]
) -> tuple[FloatArray, FloatArray]:
    """Return areas ∫ φ dS and area vectors ∫ φ n dS of the local nodes on outer facets; collective.

    Args:
        body: mesh of the body.
        model: geometric model.
        facets: of this rank.

    Returns:
        Of shapes (nodes,) and (nodes, gdim), n outward [m²].
    """
    gdim = body.mesh.geometry.dim
    tags = numbered_facets(body.mesh, [np.unique(facets).astype(np.int32)])
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    ds = ufl.Measure("ds", domain=body.mesh, subdomain_data=tags)(1)
    areas = _assembled(nodal_measure(ufl.TestFunction(body.nodes), weight, ds))
    v = ufl.TestFunction(body.vectors)
    vectors = nodal_area_vector(v, ufl.FacetNormal(body.mesh), weight, ds)
    return areas, _assembled(vectors).reshape(-1, gdim)


def _assembled(form: ufl.Form) -> FloatArray:
    """Return the values of a linear form at the local entries."""
    vector = fem.assemble_vector(fem.form(form))
    vector.scatter_reverse(la.InsertMode.add)
    vector.scatter_forward()
    return np.asarray(vector.array)


def nodal_sum(body: BodyMesh, values: npt.NDArray[Any]) -> FloatArray:
    """Return the sums over all ranks of values at the local nodes, shape (nodes, …); collective.

    Args:
        body: mesh of the body.
        values: of this rank at its local nodes, shape (nodes, …).
    """
    index_map = body.nodes.dofmap.index_map
    if values.ndim == 1 and body.mesh.comm.size > 1:
        return summed_over_ranks(index_map, values, body.nodal_sums)
    return summed_over_ranks(index_map, values)


def summed_over_ranks(
    index_map: IndexMap, values: npt.NDArray[Any], sums: la.Vector | None = None
) -> FloatArray:
    """Return the sums over all ranks of values at local places, (places, …); collective.

    Args:
        index_map: of the places.
        values: of this rank at its local places, (places, …).
        sums: a vector over the places that may be overwritten; None: one is made.
    """
    if index_map.comm.size == 1:
        return np.array(values, dtype=np.float64)
    if sums is None:
        sums = la.vector(index_map, math.prod(values.shape[1:]))
    sums.array[:] = values.ravel()
    sums.scatter_reverse(la.InsertMode.add)
    sums.scatter_forward()
    return np.asarray(sums.array.reshape(values.shape).copy())


def nodes_on_facets(body: BodyMesh, facets: IntArray) -> BoolArray:
    """Return whether the local nodes lie on some owned facets of any rank, (nodes,); collective.

    Args:
        body: mesh of the body.
        facets: owned facets of this rank.
    """
    here = fem.locate_dofs_topological(body.nodes, body.mesh.topology.dim - 1, facets)
    marks = np.zeros(len(body.parent_vertices))
    marks[here] = 1.0
    return nodal_sum(body, marks) > 0.0


def nodal_mean(body: BodyMesh, values: FloatArray) -> FloatArray:
    """Return the means over the cells around each local node of cell values; collective.

    Args:
        body: mesh of the body.
        values: of the cells, shape (cells,).

    Returns:
        Values of the local nodes, shape (nodes,).
    """
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    corners = body.nodes.dofmap.list
    nodes = corners[:owned].ravel()
    at_corners = np.repeat(values[:owned], corners.shape[1])
    total, count = (
        nodal_sum(body, np.bincount(nodes, weights, len(body.parent_vertices)))
        for weights in (at_corners, np.ones(len(nodes)))
    )
    return np.asarray(total / count)


def cell_means(body: BodyMesh, model: str, values: FloatArray) -> FloatArray:
    """Return the means of a linear nodal field over triangles or tetrahedra, shape (cells,).

    Times the volumes of the cells they add up to the values times `nodal_volumes`.

    Args:
        body: its mesh.
        model: geometric model; in an axisymmetric one outer corners count for more.
        values: at the local nodes, shape (nodes,).
    """
    corners = body.nodes.dofmap.list
    return linear_means(body.points[corners], values[corners], model)


def bounding_box(points: FloatArray, comm: MPI.Intracomm) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest coordinates of the points of all ranks; collective.

    Args:
        points: of this rank, shape (n, dimension) [m].
        comm: the ranks.

    Returns:
        Shapes (dimension,) [m].
    """
    low = np.ascontiguousarray(points.min(axis=0, initial=np.inf))
    high = np.ascontiguousarray(points.max(axis=0, initial=-np.inf))
    comm.Allreduce(MPI.IN_PLACE, low, op=MPI.MIN)
    comm.Allreduce(MPI.IN_PLACE, high, op=MPI.MAX)
    return low, high


def extent(mesh: Mesh) -> float:
    """Return the longest edge of the box round a mesh [m]; collective."""
    low, high = bounding_box(np.asarray(mesh.geometry.x, dtype=np.float64), mesh.comm)
    return float((high - low).max())
