"""Displacement formulation, for bodies that stay compressible.

The mean stress follows from the displacement, p = K (∇·u - e^θ), and is no unknown. For all η

    ∫ ∇ˢη:s + ∫ K (∇·u - e^θ) ∇·η = ∫ η·b + ∫_Γ η·t̄:

the weak form of Chiumenti, section 2.2, with its continuity equation solved for p.
"""

from __future__ import annotations

from petsc4py import PETSc

import ufl

from castx.arrays import FloatArray
from castx.domain.measures import cell_measure, nodal_mean
from castx.forms import kinematics, momentum
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.formulation import BodyUnknowns, Formulation, WeakForms, cell_stress
from castx.mechanics.loads import BodyLoads
from castx.stateful import Stateful


class DisplacementFormulation(Formulation):
    """Momentum balance of one body in its displacement alone.

    Args:
        unknowns: of the body, without a pressure.
        material: stress and tangent at its integration points.
        loads: on the body.
    """

    def __init__(self, unknowns: BodyUnknowns, material: MaterialPoints, loads: BodyLoads) -> None:
        self._unknowns, self._material = unknowns, material
        test, trial = ufl.TestFunction(unknowns.space), ufl.TrialFunction(unknowns.space)
        total, variation = unknowns.strain(unknowns.solution), unknowns.strain(test)
        points, state = material.points, material.state()
        dx = cell_measure(unknowns.mesh, unknowns.model, points.degree)
        self.forms = WeakForms(
            unknowns,
            momentum.displacement_internal_virtual_work(total, variation, state, dx),
            momentum.displacement_tangent(unknowns.strain(trial), variation, state, dx),
            loads.virtual_work(unknowns.displacement(test)),
            loads.backing,
        )
        self._strain = points.expression(kinematics.symmetric_components(total, unknowns.model))

    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Do nothing: there is no liquid in such a body."""

    def update(self) -> None:
        """Find stresses and tangents at the present displacement."""
        self._material.update(self._material.points.evaluate(self._strain))

    def residual(self) -> FloatArray:
        """Return internal minus external forces for the stresses of `update`; collective."""
        return self.forms.residual()

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the derivative of the residual."""
        self.forms.assemble_jacobian(A)

    def mean_stress(self) -> FloatArray:
        """Return K (∇·u - e^θ) of the cells [Pa], shape (cells,)."""
        return self._material.points.volumes_to_cells(self._material.mean_stress())

    def nodal_pressure(self) -> FloatArray:
        """Return means of the mean stress round the local nodes [Pa], shape (nodes,)."""
        stress = cell_stress(self._material, self.mean_stress())
        return nodal_mean(self._unknowns.mesh, stress[:, :3].mean(axis=1))

    def commit(self) -> bool:
        """Accept the trial state as the start of the next step.

        Returns:
            False: the residual stays.
        """
        self._material.commit(self._material.mean_stress())
        return False

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self._material.rewind()

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the history of the integration points."""
        return {"points": self._material}
