"""Temperatures of the nodes of a body at the start, on all ranks."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.bodies import Body
from castx.case.initial_temperature import FieldFile, InitialTemperature
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.errors import CaseError
from castx.heat.field_files import temperatures_at


def initial_temperatures(
    description: InitialTemperature, body: BodyMesh, comm: MPI.Intracomm
) -> FloatArray:
    """Return the temperatures of the owned nodes of a body [°C], shape (owned,); collective.

    A file is read on rank 0, so that every number of ranks gives the same temperatures.

    Raises:
        CaseError: the file cannot serve; on all ranks.
    """
    points = body.points[: body.nodes.dofmap.index_map.size_local]
    if description.file is None:
        return description.at(points)
    return _from_rank_zero(description.file, body, points, comm)


def initial_state(bodies: Sequence[Body], mesh: CastingMesh) -> dict[str, FloatArray]:
    """Return the initial temperatures of the owned nodes of bodies [°C] by name; collective.

    Raises:
        CaseError: a file cannot serve; on all ranks.
    """
    return {
        body.name: initial_temperatures(body.temperature, mesh.bodies[body.name], mesh.comm)
        for body in bodies
    }


def _from_rank_zero(
    file: FieldFile, body: BodyMesh, points: FloatArray, comm: MPI.Intracomm
) -> FloatArray:
    gathered = comm.gather(points)
    parts, message = None, None
    if gathered is not None:
        try:
            values = temperatures_at(file, np.concatenate(gathered))
            parts = np.split(values, np.cumsum([len(part) for part in gathered])[:-1])
        except CaseError as error:
            message = f"initial temperature of {body.name!r}: {error}"
    message = comm.bcast(message)
    if message is not None:
        raise CaseError(message)
    return np.asarray(comm.scatter(parts))
