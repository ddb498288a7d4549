"""The weak forms of one body, by its formulation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import ufl

from castx.domain.measures import cell_measure
from castx.forms import momentum, stabilisation

if TYPE_CHECKING:
    from castx.mechanics.body import BodyMechanics


class BodyForms:
    """Virtual work of the internal forces, its derivative and the loads of a body.

    Args:
        body: spaces, unknowns, points and loads.

    Attributes:
        internal: virtual work of the internal forces.
        jacobian: its derivative for changes of the unknowns.
        load: virtual work of the loads.
        total: strain of the present unknowns.
        pressure: that of the mixed formulation [Pa], else None.
        increment: strain of the trial functions.
        tau: τ_e [m²/Pa] of the mixed formulation, else None.
        dx: weighted measure of the integration points.
    """

    def __init__(self, body: BodyMechanics) -> None:
        self._body = body
        w, z = body.solution, ufl.TestFunction(body.space)
        trial = ufl.TrialFunction(body.space)
        self.total, self.increment = body.strain(w), body.strain(trial)
        self.pressure, self._change = body.split(w)[1], body.split(trial)[1]
        self._variation, self._q = body.strain(z), body.split(z)[1]
        self.dx = cell_measure(body.mesh, body.model, body.points.degree)
        self._dx_p = cell_measure(body.mesh, body.model, 2)
        self._state = body.material.state()
        if body.pockets is not None:
            self._state = self._state._replace(
                trapped=body.pockets.trapped, trapped_pressure=body.pockets.pressure
            )
        self.load = body.loads.virtual_work(body.split(z)[0])
        self.tau: Any = None
        if body.mixed:
            self._mixed()
        elif body.description.formulation == "q1p0":
            self.internal = momentum.deviatoric_virtual_work(
                self._variation, self._state, self.dx
            )
            self.jacobian = momentum.deviatoric_tangent(
                self.increment, self._variation, self._state, self.dx
            )
        else:
            self.internal = momentum.displacement_internal_virtual_work(
                self.total, self._variation, self._state, self.dx
            )
            self.jacobian = momentum.displacement_tangent(
                self.increment, self._variation, self._state, self.dx
            )

    def _mixed(self) -> None:
        body, state, q, dx_p = self._body, self._state, self._q, self._dx_p
        self.internal = momentum.mixed_internal_virtual_work(
            self.total, self.pressure, self._variation, q, state, self.dx, dx_p
        )
        self.jacobian = momentum.mixed_tangent(
            self.increment, self._change, self._variation, q, state, self.dx, dx_p
        )
        kind = body.description.stabilisation
        length = stabilisation.element_length(body.mesh.mesh, body.dimension)
        # A given pressure needs no stabilisation.
        self.tau = (1 - state.trapped) * stabilisation.tau(
            body.material.secant_modulus, length, stabilisation.CONSTANTS[kind]
        )
        self.internal -= stabilisation.pressure_laplacian(self.pressure, q, self.tau, dx_p)
        self.jacobian -= stabilisation.pressure_laplacian(self._change, q, self.tau, dx_p)
        if kind == "gls":
            force = body.loads.body_force
            self.load += stabilisation.body_force_residual(q, force, self.tau, dx_p)
