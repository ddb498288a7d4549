"""Measures of cells and surfaces of a body that carry the weight of the model."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la
from dolfinx.mesh import Mesh

from castx.arrays import FloatArray
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics


def cell_measure(body: BodyMesh, model: str, degree: int) -> kinematics.WeightedMeasure:
    """Return the weighted measure of the cells of a body, exact for a polynomial degree."""
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    measure = ufl.Measure("dx", domain=body.mesh, metadata={"quadrature_degree": degree})
    return kinematics.WeightedMeasure(weight, measure)


def surface_measure(body: BodyMesh, model: str, degree: int) -> kinematics.WeightedMeasure:
    """Return the weighted measure of the surfaces of a body, exact for a polynomial degree."""
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    measure = ufl.Measure(
        "ds",
        domain=body.mesh,
        subdomain_data=body.facet_tags,
        metadata={"quadrature_degree": degree},
    )
    return kinematics.WeightedMeasure(weight, measure)


def nodal_volumes(body: BodyMesh, model: str) -> FloatArray:
    """Return the volumes of the owned nodes of a body [m³], shape (owned,)."""
    volumes = fem.assemble_vector(
        fem.form(ufl.TestFunction(body.nodes) * cell_measure(body, model, 2))
    )
    volumes.scatter_reverse(la.InsertMode.add)
    return np.asarray(volumes.array[: body.nodes.dofmap.index_map.size_local])


def nodal_sum(body: BodyMesh, values: npt.NDArray[Any]) -> FloatArray:
    """Return at the local nodes the sums of what all ranks have there, shape (nodes,)."""
    sums = la.vector(body.nodes.dofmap.index_map)
    sums.array[:] = values
    sums.scatter_reverse(la.InsertMode.add)
    sums.scatter_forward()
    return np.asarray(sums.array.copy())


def bounding_box(points: FloatArray, comm: MPI.Intracomm) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest coordinates of the points of all ranks, shape (dimension,)."""
    low = np.ascontiguousarray(points.min(axis=0, initial=np.inf))
    high = np.ascontiguousarray(points.max(axis=0, initial=-np.inf))
    comm.Allreduce(MPI.IN_PLACE, low, op=MPI.MIN)
    comm.Allreduce(MPI.IN_PLACE, high, op=MPI.MAX)
    return low, high


def extent(mesh: Mesh) -> float:
    """Return the largest edge of the box round a mesh [m]."""
    low, high = bounding_box(np.asarray(mesh.geometry.x, dtype=np.float64), mesh.comm)
    return float((high - low).max())
