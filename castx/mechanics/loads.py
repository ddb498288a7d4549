"""External forces on one body: body force, pressures, tractions and clamps of its surfaces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.measures import SurfaceMeasures, cell_measure
from castx.domain.mesh import BodyMesh
from castx.domain.surface_values import EvenValue, UnevenValue
from castx.forms import momentum
from castx.mechanics.clamp import Clamp
from castx.mechanics.description import MechanicalBody, SurfaceLoad
from castx.tables import Table


class BodyLoads:
    """The loads of a body as constants in a form, changed by value.

    Args:
        body: mesh of the body.
        model: geometric model.
        description: loads of the body.
        degree: to which virtual work is integrated.

    Attributes:
        body_force: force per volume b [N/m³], for forms.
        clamps: machines that press on its surfaces.
    """

    def __init__(
        self, body: BodyMesh, model: str, description: MechanicalBody, degree: int = 2
    ) -> None:
        self._body, self._model, self._loads = body, model, tuple(description.loads)
        self._degree = degree
        dimension = body.mesh.geometry.dim
        force = description.body_force
        self._uniform: FloatArray = np.zeros(dimension)
        if callable(force):
            self.body_force = force(ufl.SpatialCoordinate(body.mesh))
        else:
            self._uniform[: len(force)] = force[:dimension]
            self.body_force = fem.Constant(body.mesh, self._uniform)
        self._values = [_value_of(body, load) for load in self._loads]
        loaded = [load.surface for load in self._loads]
        loaded += [given.surface for given in description.clamps]
        self._measures = SurfaceMeasures(body, model, loaded)
        self.clamps = [Clamp(body, model, given, self._measures) for given in description.clamps]
        self._backed = [given for given in self.clamps if given.stiffness > 0]

    @property
    def weighs(self) -> bool:
        """Whether a uniform body force acts."""
        return bool(np.any(self._uniform))

    @property
    def uniform_force(self) -> FloatArray:
        """The body force [N/m³], shape (dimension,), zero where it depends on the position."""
        return self._uniform

    def potential(self) -> FloatArray:
        """Return x·b at the local nodes [Pa], shape (nodes,): pressures at rest differ by it.

        A body force that depends on the position counts as none.
        """
        return np.asarray(self._body.points @ self._uniform)

    def set_time(self, time: float) -> None:
        """Set the loads of a time [s]; collective.

        Raises:
            CaseError: a load that varies in space is not finite; on all ranks.
        """
        for value in self._values:
            value.set_time(time)
        for clamp in self.clamps:
            clamp.set_time(time)

    def pressures(self) -> dict[str, float | FloatArray]:
        """Return the pressures that push on surfaces at the present time, by surface [Pa].

        Those that vary in space are at its local nodes, shape (nodes,).
        """
        found: dict[str, float | FloatArray] = {}
        for load, value in zip(self._loads, self._values, strict=True):
            if load.pressure is not None:
                found[load.surface] = found.get(load.surface, 0.0) + value.pressures
        return found

    def virtual_work(self, eta: Any) -> Any:
        """Return ∫ η·b + ∫_Γ η·t̄ - ∫_Γ p̄ η·n for a variation η, t̄ with the force of clamps."""
        dx = cell_measure(self._body, self._model, self._degree)
        normal = ufl.FacetNormal(self._body.mesh)
        work = momentum.body_force_work(eta, self.body_force, dx)
        for load, value in zip(self._loads, self._values, strict=True):
            measure = self._measures(load.surface, self._degree)
            if load.pressure is not None:
                work += momentum.pressure_work(eta, value.coefficient, normal, measure)
            else:
                work += momentum.traction_work(eta, value.coefficient, measure)
        for clamp in self.clamps:
            work += clamp.work(eta)
        return work

    @property
    def backing(self) -> Callable[[Any, Any], Any] | None:
        """Work of a variation against the springs that a displacement strains; None: no springs."""
        return self._backing_work if self._backed else None

    def _backing_work(self, eta: Any, u: Any) -> Any:
        return sum(clamp.backing_work(eta, u) for clamp in self._backed)

    def held(self, motion: FloatArray) -> FloatArray:
        """Return the elongation of the springs under a motion, shape (springs,).

        Args:
            motion: of the owned nodes, shape (owned, dimension).
        """
        return np.concatenate([np.zeros(0), *(clamp.strained(motion) for clamp in self._backed)])


def _value_of(body: BodyMesh, load: SurfaceLoad) -> EvenValue | UnevenValue:
    components = load.traction if load.pressure is None else (load.pressure,)
    assert components is not None
    scalar = load.pressure is not None
    even = tuple(each for each in components if isinstance(each, Table))
    if len(even) == len(components):
        return EvenValue(body, even, scalar)
    return UnevenValue(body, load.surface, components, scalar)
