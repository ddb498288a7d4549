"""The direction in which a machine presses on a surface."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.domain.measures import nodal_area_vectors, nodal_areas
from castx.domain.mesh import BodyMesh
from castx.errors import CaseError

FLAT = 1e-6
"""Part by which the mean normal of a flat surface may be shorter than one."""

LEAST = 0.05
"""Least part of a surface that must face a stated axis."""


def press_direction(
    body: BodyMesh, model: str, surface: str, axis: int | None = None
) -> tuple[FloatArray, float]:
    """Return the unit vector in which a machine presses on a surface, and its area; collective.

    Args:
        body: mesh of the body.
        model: geometric model.
        surface: name of the surface.
        axis: number of the coordinate along which it presses; None: against the normal.

    Returns:
        The vector into the body, shape (dimension,), and the area [m²]: of the full turn when
        axisymmetric, of one metre of depth in plane models, of the meshed part in space.

    Raises:
        CaseError: the surface is not flat and no axis is stated, or it does not face the axis.
        MeshError: the body has no such surface.
    """
    outward, area = mean_normal(body, model, surface)
    if model == "axisymmetric":
        outward[0] = 0.0  # cancels over the turn
    place = f"boundary '{body.name}/{surface}', clamp"
    if axis is None:
        length = float(np.linalg.norm(outward))
        if length < 1.0 - FLAT:
            raise CaseError(
                f"{place}: the surface is not flat, so that a force along its normals has another "
                'resultant; state the direction of the machine, such as direction = "z", or use '
                "pressure"
            )
        return np.asarray(-outward / length, dtype=np.float64), area
    if abs(outward[axis]) < LEAST:
        raise CaseError(
            f"{place}.direction: only {abs(outward[axis]):.2g} of the surface faces along it, so "
            "that nothing could press there; name another direction or surface"
        )
    direction = np.zeros_like(outward)
    direction[axis] = -np.sign(outward[axis])
    return direction, area


def mean_normal(body: BodyMesh, model: str, surface: str) -> tuple[FloatArray, float]:
    """Return the mean of the outward normals of a surface, and its area; collective.

    Args:
        body: mesh of the body.
        model: geometric model.
        surface: name of the surface.

    Returns:
        The mean, shape (dimension,), of length one where the surface is flat, and the area as of
        `press_direction` [m²].

    Raises:
        MeshError: the body has no such surface.
    """
    owned = body.nodes.dofmap.index_map.size_local
    vectors = nodal_area_vectors(body, model, surface, 2)[:owned]
    areas = nodal_areas(body, model, surface, 2)[:owned]
    own = np.append(vectors.sum(axis=0), areas.sum())
    sums = body.mesh.comm.allreduce(own, op=MPI.SUM)
    return sums[:-1] / sums[-1], float(sums[-1])
