"""Stress and tangent of the integration points as functions, of which the forms are made."""

from __future__ import annotations

from typing import Any

from castx.forms import kinematics
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Law
from castx.mechanics.constitutive.response import Response


class PointFunctions:
    """Functions of stress and tangent, which take the values of a response.

    Args:
        points: integration points of the body.
        law: law of the body.
    """

    def __init__(self, points: IntegrationPoints, law: Law) -> None:
        self._model, self._flows, self._layers = points.model, not law.is_linear, law.has_layers
        self.stress, self.isotropic = points.tensor(), points.scalar()
        self.direction, self.radial = points.tensor(), points.scalar()
        if self._layers:
            self.beside_direction, self.beside_radial = points.tensor(), points.scalar()

    def take(self, response: Response) -> None:
        """Take the values of a response at all points."""
        self.stress.x.array[:] = response.stress.ravel()
        self.isotropic.x.array[:] = response.isotropic
        if self._flows:
            self.radial.x.array[:] = response.radial
            self.direction.x.array[:] = response.direction.ravel()
        if response.beside is not None:
            self.beside_radial.x.array[:] = response.beside.radial
            self.beside_direction.x.array[:] = response.beside.direction.ravel()

    def tensors(self) -> dict[str, Any]:
        """Return stress and tangent by the names of `castx.forms.momentum.PointState`."""

        def tensor(function: Any) -> Any:
            return kinematics.symmetric_tensor(function, self._model)

        flowing: dict[str, Any] = {"radial": None, "direction": None}
        if self._flows:
            flowing = {"radial": self.radial, "direction": tensor(self.direction)}
        beside = (self.beside_radial, tensor(self.beside_direction)) if self._layers else None
        stress = {"stress": tensor(self.stress), "isotropic": self.isotropic}
        return {**stress, **flowing, "beside": beside}
