"""Flatness and roundness of the surfaces that a case selects, as they are deformed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import FloatArray
from castx.domain.measures import nodal_areas
from castx.foundry.roundness import flatness, roundness
from castx.foundry.stress.shape import is_axis, plane_of

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh


class SurfaceForms:
    """Flatness and roundness of surfaces; their images beyond planes of symmetry count too.

    Args:
        mesh: of all bodies.
        flat: surfaces "body/surface" that should be planes.
        rounds: those that should be circles, in plane models.
    """

    def __init__(self, mesh: CastingMesh, flat: Sequence[str], rounds: Sequence[str]) -> None:
        self._mesh = mesh
        self._flat, self._round = ([on.split("/", 1) for on in names] for names in (flat, rounds))

    def of(self, body: str, displacement: FloatArray) -> dict[str, dict[str, float]]:
        """Return flatness and roundness of the surfaces of a body by name [m]; collective.

        Args:
            body: its name.
            displacement: of the local nodes, (nodes, gdim) [m].
        """
        found = {}
        for name, chosen in (("flatness", self._flat), ("roundness", self._round)):
            surfaces = [surface for owner, surface in chosen if owner == body]
            if surfaces:
                found[name] = {on: self._form(name, body, on, displacement) for on in surfaces}
        return found

    def _form(self, name: str, body: str, surface: str, displacement: FloatArray) -> float:
        mesh, model = self._mesh.bodies[body], self._mesh.model
        nodes = mesh.surface_nodes(surface)
        nodes = nodes[nodes < mesh.node_numbering.owned]
        areas = nodal_areas(mesh, model, surface)[nodes]
        own = np.column_stack([mesh.points[nodes] + displacement[nodes], areas])
        *columns, weights = np.concatenate(mesh.mesh.comm.allgather(own)).T
        points = np.column_stack(columns)
        if model == "axisymmetric":
            return float(np.ptp(points[:, 1]))  # the plane stands across the axis
        for plane_name in mesh.symmetry_planes:
            plane = None if is_axis(mesh, model, plane_name) else plane_of(mesh, model, plane_name)
            if plane is not None:
                points = np.concatenate([points, plane.image(points)])
                weights = np.concatenate([weights, weights])
        return (flatness if name == "flatness" else roundness)(points, weights)
