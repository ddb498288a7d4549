"""Mixed u/p formulation on linear simplices, stabilised by GLS or OSGS (Chiumenti, section 2.2).

Displacement and pressure are unknowns of the nodes. For all η and q

    ∫ ∇ˢη:s + ∫ p ∇·η = ∫ η·b + ∫_Γ η·t̄,
    ∫ q (∇·u - p/K - e^θ) - Σ_e τ_e ∫ ∇q·(∇p - Π) = 0,

with Π = -b in GLS and the projection of ∇p to the nodes in OSGS (`castx.mechanics.osgs`). Dropping
b from GLS is wrong by half and more where a body has a liquid core. What GLS drops of ∇·s in
axisymmetric bodies, (s_rr - s_θθ)/r and s_rz/r, falls with the square of the element size. The
formula of τ_e, and where its shear modulus comes from, stands at `castx.forms.stabilisation.tau`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.measures import cell_measure
from castx.forms import kinematics, momentum, stabilisation
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import BodyUnknowns, Formulation, Product, WeakForms
from castx.mechanics.loads import BodyLoads
from castx.mechanics.osgs import OrthogonalProjection
from castx.mechanics.trapped_liquid import TrappedLiquid
from castx.stateful import Stateful


class PressureFormulation(Formulation):
    """Formulation in displacement and nodal pressure: its unknowns, strain, stress and τ_e.

    Args:
        unknowns: of the body, with the pressure.
        material: stress and tangent at its integration points.
    """

    def __init__(self, unknowns: BodyUnknowns, material: MaterialPoints) -> None:
        self._unknowns, self._material = unknowns, material
        points = material.points
        self._total = unknowns.total_strain(material.thickness)
        self._p = unknowns.pressure(unknowns.solution)
        self._dx = cell_measure(unknowns.mesh, unknowns.model, points.degree)
        self._dx_p = cell_measure(unknowns.mesh, unknowns.model, max(2, points.degree))
        components = kinematics.symmetric_components(self._total, unknowns.model)
        self._strain, self._pressure = points.expression(components), points.expression(self._p)

    def _test(self) -> tuple[Any, Any]:
        """Return strain ε(η) and pressure q of the test functions."""
        test = ufl.TestFunction(self._unknowns.space)
        return self._strain_of(test), self._unknowns.pressure(test)

    def _trial(self) -> tuple[Any, Any]:
        """Return strain and pressure of the trial functions."""
        trial = ufl.TrialFunction(self._unknowns.space)
        return self._strain_of(trial), self._unknowns.pressure(trial)

    def _strain_of(self, change: Any) -> Any:
        return self._unknowns.strain(change, self._material.thickness.follows)

    def _tau(self, kind: str) -> Any:
        """Return τ_e of a stabilisation [m²/Pa]."""
        length = stabilisation.element_length(self._unknowns.mesh.mesh, self._unknowns.dimension)
        constant = stabilisation.CONSTANTS[kind]
        return stabilisation.tau(self._material.secant_modulus, length, constant)

    def update(self) -> None:
        """Find stresses and tangents at the present displacement and pressure."""
        points = self._material.points
        pressure = points.evaluate(self._pressure)[:, 0]
        self._material.update(points.evaluate(self._strain), pressure)

    def nodal_pressure(self) -> FloatArray:
        """Return the pressure at the local nodes [Pa], shape (nodes,)."""
        unknowns = self._unknowns
        scaled = unknowns.solution.x.array[unknowns.pressure_component :: unknowns.block_size]
        return np.asarray(unknowns.pressure_scale * scaled)


class PocketedFormulation(PressureFormulation):
    """Formulation in displacement and nodal pressure of a body that may hold trapped liquid.

    Args:
        unknowns: of the body, with the pressure.
        material: stress and tangent at its integration points.
        pockets: its trapped liquid.
    """

    def __init__(
        self, unknowns: BodyUnknowns, material: MaterialPoints, pockets: TrappedLiquid
    ) -> None:
        super().__init__(unknowns, material)
        self._pockets = pockets

    def coupled_products(self) -> list[Product]:
        """Return the products of the Jacobian of full pockets of trapped liquid."""
        return [self._pockets.stiffness.add_product]

    @property
    def has_pockets(self) -> bool:
        """Whether there is trapped liquid in the trial step, whose pores may open and close."""
        return self._pockets.exist

    def liquid_totals(self) -> dict[str, float] | None:
        """Return feeding demand, pores and pressure; None for a body that never is a liquid."""
        return self._pockets.totals()

    def pores(self) -> FloatArray:
        """Return the pores of the cells after the last accepted step, as shares, (cells,)."""
        return self._pockets.pores

    def commit(self) -> bool:
        """Accept the trial state as the start of the next step; collective.

        Returns:
            False: the residual stays.
        """
        at_points = self.point_pressure()
        pressure = self.mean_stress() if at_points is None else at_points
        self._material.commit(pressure, self._pockets.hold_volume)
        self._pockets.commit(self.nodal_pressure, self._material.dilatation)
        return False

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self._material.rewind()
        self._pockets.rewind()

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the histories of the integration points and of trapped liquid."""
        return {"points": self._material, **self._pockets.stateful_parts()}


class MixedFormulation(PocketedFormulation):
    """Momentum balance of one body in its displacement and pressure.

    Args:
        unknowns: of the body, with the pressure.
        material: stress and tangent at its integration points.
        loads: on the body.
        pockets: its trapped liquid.
        kind: stabilisation, "osgs" or "gls".
        planes: symmetry planes, behind which the body goes on as its mirror image.
    """

    def __init__(
        self,
        unknowns: BodyUnknowns,
        material: MaterialPoints,
        loads: BodyLoads,
        pockets: TrappedLiquid,
        kind: str,
        planes: Sequence[FixedDirections],
    ) -> None:
        super().__init__(unknowns, material, pockets)
        state = pockets.state(material.state())
        # A given pressure needs no stabilisation.
        tau = (1 - state.trapped) * self._tau(kind)
        self.forms = WeakForms(
            unknowns,
            self._internal(self._total, self._p, state, tau),
            self._jacobian(state, tau),
            self._load(loads, kind, tau),
            loads.backing,
            unknowns.held(material.thickness, self._dx),
        )
        variation, q = self._test()
        self._of_pockets = [
            fem.form(momentum.pocket_pressure_work(variation, each, state, self._dx_p))
            for each in (0.0, q)
        ]
        phases: list[Any] = []
        if kind == "osgs":
            solid = material.bearing
            phases = [solid, 1 - solid] if material.law.freezes else [1]
        self._projections = [
            OrthogonalProjection(unknowns, phase * tau, planes) for phase in phases
        ]

    def _internal(self, total: Any, pressure: Any, state: momentum.PointState, tau: Any) -> Any:
        """Return ∫ ∇ˢη:s + ∫ p ∇·η + ∫ q (∇·u - p/K - e^θ) - Σ_e τ_e ∫ ∇q·∇p."""
        variation, q = self._test()
        work = momentum.mixed_internal_virtual_work(
            total, pressure, variation, q, state, self._dx, self._dx_p
        )
        work -= stabilisation.pressure_laplacian(pressure, q, tau, self._dx_p)
        return work

    def _jacobian(self, state: momentum.PointState, tau: Any) -> Any:
        """Return the derivative of `_internal` for a change of displacement and pressure."""
        (increment, change), (variation, q) = self._trial(), self._test()
        work = momentum.mixed_tangent(increment, change, variation, q, state, self._dx, self._dx_p)
        work -= stabilisation.pressure_laplacian(change, q, tau, self._dx_p)
        return work

    def _load(self, loads: BodyLoads, kind: str, tau: Any) -> Any:
        """Return ∫ η·b + ∫_Γ η·t̄, in GLS with Σ_e τ_e ∫ ∇q·b."""
        test = ufl.TestFunction(self._unknowns.space)
        work = loads.virtual_work(self._unknowns.displacement(test))
        if kind == "gls":
            q = self._unknowns.pressure(test)
            work += stabilisation.body_force_residual(q, loads.body_force, tau, self._dx_p)
        return work

    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Find trapped liquid and projection for a trial step; collective."""
        self._pockets.begin(self._material, solid_fraction)
        if self._pockets.exist:
            self._pockets.stiffen(*(self.forms.assemble(form) for form in self._of_pockets))
        self._assemble_projections()

    def _assemble_projections(self) -> None:
        for projection in self._projections:
            projection.assemble()

    def residual(self) -> FloatArray:
        """Return internal minus external forces for the stresses of `update`; collective."""
        self._pockets.evaluate(self._material.dilatation)
        b = self.forms.residual()
        for add_product in self.products():
            add_product(self._unknowns.solution.x.array, b)
        return b

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the Jacobian; for OSGS the one of GLS, as a preconditioner."""
        self.forms.assemble_jacobian(A)

    def products(self) -> list[Product]:
        """Return the part of OSGS beyond GLS, Σ_e τ_e ∫ ∇q·Π(p), linear in the pressures."""
        return [projection.add_product for projection in self._projections]

    def matrix_of_products(self) -> PETSc.Mat | None:
        """Return the same as a matrix, which the caller destroys; None with GLS; collective."""
        found, *others = [projection.matrix() for projection in self._projections] or [None]
        for other in others:
            found.axpy(1.0, other, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            other.destroy()
        return found

    def mean_stress(self) -> FloatArray:
        """Return means of the nodal pressures, or pressures of pockets, [Pa], shape (cells,)."""
        nodes = self._unknowns.mesh.nodes.dofmap.list
        given = self._pockets.cell_pressures()
        return np.where(np.isnan(given), self.nodal_pressure()[nodes].mean(axis=1), given)

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        super().rewind()
        self._assemble_projections()
