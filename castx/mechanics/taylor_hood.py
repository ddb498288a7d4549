"""Taylor-Hood formulation: quadratic displacement and linear pressure on simplices.

The displacement is linear between the nodes and has a bubble at each mid-side beside that
(`castx.mechanics.midsides`), the pressure is linear. For all η, of nodes and mid-sides, and q

    ∫ ∇ˢη:s + ∫ p ∇·η = ∫ η·b + ∫_Γ η·t̄,
    ∫ q (∇·u - p/K - e^θ) = 0,

without stabilisation: the spaces are stable together. A wall bends with one cell across. Strains
vary in a cell, so that its volume, 1/K and e^θ stand at the integration points.

Source: C. Taylor and P. Hood, Computers & Fluids 1 (1973) 73.
"""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.forms import momentum
from castx.forms.momentum import PointState
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.formulation import BodyUnknowns, MidsideForms, WeakForms
from castx.mechanics.loads import BodyLoads
from castx.mechanics.mixed import PocketedFormulation
from castx.mechanics.trapped_liquid import TrappedLiquid


class TaylorHoodFormulation(PocketedFormulation):
    """Momentum balance of one body in its quadratic displacement and its linear pressure.

    Args:
        unknowns: of the body, with the pressure and mid-sides.
        material: stress and tangent at its integration points, each of which has a volume.
        loads: on the body.
        pockets: its trapped liquid.
    """

    midside_forms: MidsideForms

    def __init__(
        self,
        unknowns: BodyUnknowns,
        material: MaterialPoints,
        loads: BodyLoads,
        pockets: TrappedLiquid,
    ) -> None:
        super().__init__(unknowns, material, pockets)
        assert unknowns.midsides is not None
        midsides = unknowns.midsides
        test, trial = ufl.TestFunction(midsides.space), ufl.TrialFunction(midsides.space)
        state = pockets.state(material.state())
        of_nodes, of_midsides = self._test(), (midsides.strain(test), ufl.as_ufl(0.0))
        change, bubble = self._trial(), (midsides.strain(trial), ufl.as_ufl(0.0))
        eta = unknowns.displacement(ufl.TestFunction(unknowns.space))
        self.forms = WeakForms(
            unknowns,
            self._internal(of_nodes, state),
            self._tangent(change, of_nodes, state),
            loads.virtual_work(eta),
            held=unknowns.held(material.thickness, self._dx),
        )
        self.midside_forms = MidsideForms(
            midsides,
            self._internal(of_midsides, state),
            self._tangent(bubble, of_midsides, state),
            loads.virtual_work(midsides.displacement(test)),
            self._tangent(change, of_midsides, state),
        )
        self._of_pockets = [
            [self._pocket_work(*work, state) for work in ((of_nodes[0], q), (of_midsides[0], 0.0))]
            for q in (0.0, of_nodes[1])
        ]

    def _internal(self, variation: tuple[Any, Any], state: PointState) -> Any:
        """Return ∫ ∇ˢη:s + ∫ p ∇·η + ∫ q (∇·u - p/K - e^θ) for ε(η) and q."""
        return momentum.mixed_internal_virtual_work(
            self._total, self._p, *variation, state, self._dx, self._dx_p
        )

    def _tangent(
        self, change: tuple[Any, Any], variation: tuple[Any, Any], state: PointState
    ) -> Any:
        """Return the derivative of `_internal` for a change of strain and pressure."""
        return momentum.mixed_tangent(*change, *variation, state, self._dx, self._dx_p)

    def _pocket_work(self, variation: Any, q: Any, state: PointState) -> fem.Form:
        work: fem.Form = fem.form(momentum.pocket_pressure_work(variation, q, state, self._dx_p))
        return work

    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Find trapped liquid for a trial step; collective."""
        self._pockets.begin(self._material, solid_fraction)
        if self._pockets.exist:
            balances = self.forms, self.midside_forms
            self._pockets.stiffen(
                *(
                    np.concatenate([b.assemble(f) for b, f in zip(balances, forms, strict=True)])
                    for forms in self._of_pockets
                )
            )

    def update_load(self) -> None:
        """Assemble the loads of nodes and mid-sides at their present values; collective."""
        self.forms.update_load()
        self.midside_forms.update_load()

    def residual(self) -> FloatArray:
        """Return internal minus external forces for the stresses of `update`; collective."""
        self._pockets.evaluate(self._material.dilatation)
        return self.forms.residual()

    def midside_residual(self) -> FloatArray:
        """Return the forces on the mid-sides, after those on the nodes; collective."""
        return self.midside_forms.residual()

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the derivative of the rows of the nodes for a change of their unknowns."""
        self.forms.assemble_jacobian(A)

    def mean_stress(self) -> FloatArray:
        """Return means of the pressure, or pressures of pockets, [Pa], shape (cells,)."""
        return self._material.points.cell_means(self.point_pressure())

    def point_pressure(self) -> FloatArray:
        """Return the pressure at the integration points [Pa], shape (points,)."""
        points = self._material.points
        given = points.from_cells(self._pockets.cell_pressures())
        return np.where(np.isnan(given), points.evaluate(self._pressure)[:, 0], given)
