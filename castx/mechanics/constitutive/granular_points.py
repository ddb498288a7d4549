"""Integration points of grains with a binder, which yield by their mean stress and change volume.

The mean stress that yields is that of the strain at the point,

    p = K (θ − E − Δθ_p),

so that grains have the formulation in displacement alone. A pressure that is an unknown of the
nodes does not serve: at the cut-off the flow does not follow from a given pressure, and beside one
that is smooth from cell to cell, with Δθ_p in the balance of volume, the shear that a cell bears by
its own mean stress finds no equilibrium at a hot edge. Nothing locks for that: grains stay
compressible. From step to step Δθ_p stays in the volumetric strain without pressure, E
(`growth.CellVolume`).

Grains that let go have no stiffness. The matrix takes `SMALLEST_STIFFNESS` of the elastic one
there, the stress none, so that only the way of Newton's method to the solution changes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.forms.momentum import PlasticVolume, PointState
from castx.materials.enthalpy import HeatState
from castx.materials.granular import GranularData, GranularSurface, granular_surface
from castx.mechanics.constitutive.drucker_prager import GranularReturn, relaxed, return_to_cone
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Conditions, Law
from castx.mechanics.constitutive.plane_stress import deviatoric
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.constitutive.response import Response
from castx.mechanics.constitutive.return_mapping import tensor_norm
from castx.stateful import Arrays, Saved

SMALLEST_STIFFNESS = 1e-3
"""Least part of 2 G that the matrix takes in shear."""


class GranularPoints(MaterialPoints):
    """Stress, tangent, flow of the volume and history of all points of a body of grains.

    Args:
        points: integration points, each of which has a volume of its own.
        law: law of the body, whose material has `granular`.
        cells: functions constant in each cell.
    """

    def __init__(self, points: IntegrationPoints, law: Law, cells: fem.FunctionSpace) -> None:
        super().__init__(points, law, cells, starts_liquid=False)
        granular = law.material.description.granular
        assert isinstance(granular, GranularData)  # as `check_law` has found
        self._granular = granular
        self._flowed = PlasticVolume(*(points.scalar() for _ in PlasticVolume._fields))
        self._hottest: FloatArray = np.full(len(points.node_numbering.numbers), -np.inf)
        self._trial_hottest: FloatArray = self._hottest
        self._surface: GranularSurface | None = None
        self._committed_surface: GranularSurface | None = None

    def state(self) -> PointState:
        """Return the functions for the forms."""
        return super().state()._replace(plastic_volume=self._flowed)

    def begin(
        self,
        temperature: FloatArray,
        solid_fraction: FloatArray,
        step: float,
        between: Sequence[HeatState] = (),
    ) -> Conditions:
        """Evaluate law and yield surface for a trial step, see `MaterialPoints.begin`."""
        self._trial_hottest = np.maximum(self._hottest, temperature)
        self._surface = granular_surface(
            self._granular, self.points.from_nodes(self._trial_hottest)
        )
        return super().begin(temperature, solid_fraction, step, between)

    def update(self, strain: FloatArray, pressure: FloatArray | None = None) -> None:
        """Update stress, tangent and flow for a total strain at the end of the step.

        Args:
            strain: shape (points, components).
            pressure: None: it is no unknown.

        Raises:
            ConvergenceError: a strain is not finite.
        """
        c, start, surface = self.conditions, self._start, self._surface
        assert surface is not None
        self._strain = strain
        G, K = c.shear_modulus, 1 / c.solid_compressibility
        elastic = start.elastic + deviatoric(strain) - start.strain
        mean = K * (strain[:, :3].sum(axis=1) - self.thermal_strain.x.array)
        trial, relaxation = (2 * G)[:, None] * elastic, self._granular.relaxation_time
        on_surface = return_to_cone(trial, mean, G, K, surface)
        share = relaxation / (relaxation + self._step)
        found = relaxed(on_surface, trial, mean, G, K, share)
        self._response = _response(found, start, elastic)
        self.functions.take(self._response)
        self.functions.isotropic.x.array[:] = np.maximum(
            found.isotropic, SMALLEST_STIFFNESS * 2 * G
        )
        for function, values in zip(
            self._flowed,
            (found.dilatation, found.stress_by_volume, found.mean_by_shear, found.bulk),
            strict=True,
        ):
            function.x.array[:] = values

    def mean_stress(self) -> FloatArray:
        """Return K (∇·u - e^θ - Δθ_p) of the points [Pa], shape (points,)."""
        flowed = self._flowed.dilatation.x.array / self.conditions.compressibility
        return np.asarray(super().mean_stress() - flowed)

    def commit(self, mean_stress: FloatArray, pooled: BoolArray | None = None) -> None:
        """Accept the trial state as the start of the next step, see `MaterialPoints.commit`."""
        super().commit(mean_stress, pooled)
        flowed = self._flowed.dilatation.x.array
        self._volume = self._volume._replace(free=self._volume.free + flowed)
        self._hottest, self._committed_surface = self._trial_hottest, self._surface

    def rewind(self) -> None:
        """Return to the end of the last accepted step."""
        super().rewind()
        self._trial_hottest = self._hottest
        if self._committed_surface is not None:
            self._surface = self._committed_surface

    def saved(self) -> dict[str, Saved]:
        """Return the history, and the highest temperature of the nodes so far."""
        return super().saved() | {"hottest": Saved(self._hottest, self.points.node_numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Restore the history with which the next step starts."""
        super().restore(arrays)
        self._hottest, self._committed_surface = arrays["hottest"].copy(), None


def _response(found: GranularReturn, start: PointHistory, elastic: FloatArray) -> Response:
    """Return the part of a state that all laws have."""
    flow = (np.sqrt(1.5) * found.increment)[:, None] * found.direction
    shear = np.sqrt(1.5) * tensor_norm(found.stress)
    work = shear * found.increment + found.mean * found.dilatation
    return Response(
        found.stress, found.isotropic, found.radial, found.direction,
        elastic - flow, start.plastic + flow, start.equivalent + found.increment, work,
    )  # fmt: skip
