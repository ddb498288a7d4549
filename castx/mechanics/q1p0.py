"""Q1/P0 formulation on quadrilaterals and hexahedra: a constant pressure in each cell.

The pressure of a cell is not an unknown of the nodes: with means over the cell,

    ∫ ∇ˢη:s + Σ_e p_e ∫ ∇·η = ∫ η·b + ∫_Γ η·t̄,   p_e = (mean(∇·u) - e^θ)/c,   c = 1/K.

Where c is zero or small p_e becomes a multiplier, found together with the displacement:

    p = [mean(∇·u) - e^θ + (ĉ - c) p_k] / ĉ,   ĉ = max(c, a small number),   p_k ← p.

Source: J. C. Nagtegaal, D. M. Parks and J. R. Rice, Computer Methods in Applied Mechanics and
Engineering 4 (1974); T. J. R. Hughes, International Journal for Numerical Methods in Engineering 15
(1980); for the multiplier M. Fortin and R. Glowinski, Augmented Lagrangian Methods (1983), ch. 1.
"""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.arrays import BoolArray, FloatArray
from castx.domain.measures import cell_measure, nodal_mean
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics, momentum
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.formulation import (
    BodyUnknowns,
    Formulation,
    Product,
    WeakForms,
    cell_stress,
)
from castx.mechanics.loads import BodyLoads
from castx.mechanics.trapped_liquid import TrappedLiquid
from castx.stateful import Arrays, Saved, Stateful

SMALLEST_COMPRESSIBILITY = 1e-3
"""ĉ of an incompressible cell in units of 1/G: the error of p falls so fast in each iteration."""


class Q1P0Formulation(Formulation):
    """Momentum balance of one body in its displacement, with the pressures of `MeanDilatation`.

    Args:
        unknowns: of the body, without a pressure.
        material: stress and tangent at its integration points.
        loads: on the body.
        pockets: its trapped liquid.
        cells: functions constant in each cell.
        shear_modulus: largest shear modulus of the body [Pa].
    """

    def __init__(
        self,
        unknowns: BodyUnknowns,
        material: MaterialPoints,
        loads: BodyLoads,
        pockets: TrappedLiquid,
        cells: fem.FunctionSpace,
        shear_modulus: float,
    ) -> None:
        self._unknowns, self._material, self._pockets = unknowns, material, pockets
        test, trial = ufl.TestFunction(unknowns.space), ufl.TrialFunction(unknowns.space)
        thickness, points = material.thickness, material.points
        total = unknowns.strain(unknowns.solution, thickness.follows, thickness.kept)
        increment = unknowns.strain(trial, thickness.follows)
        variation = unknowns.strain(test, thickness.follows)
        state = pockets.state(material.state())
        dx = cell_measure(unknowns.mesh, unknowns.model, points.degree)
        self.forms = WeakForms(
            unknowns,
            momentum.deviatoric_virtual_work(variation, state, dx),
            momentum.deviatoric_tangent(increment, variation, state, dx),
            loads.virtual_work(unknowns.displacement(test)),
            loads.backing,
            unknowns.held(thickness, dx),
        )
        self._strain = points.expression(kinematics.symmetric_components(total, unknowns.model))
        self._mean = MeanDilatation(
            unknowns.mesh, cells, unknowns.space, increment, dx, shear_modulus
        )

    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Find trapped liquid and mean dilatation for a trial step; collective."""
        self._pockets.begin(self._material, solid_fraction)
        material = self._material
        self._mean.begin(
            material.compressibility.x.array,
            material.thermal_strain.x.array,
            self._pockets.cell_pressures(),
        )
        if self._pockets.exist:
            rows = self._mean.forces_of(self._mean.given.astype(np.float64))
            self._pockets.stiffen(rows, rows)

    def update(self) -> None:
        """Find stresses, tangents and pressures at the present displacement."""
        self._material.update(self._material.points.evaluate(self._strain))
        self._mean.update(self._material.dilatation)

    def residual(self) -> FloatArray:
        """Return internal minus external forces for the stresses of `update`; collective."""
        self._pockets.evaluate(self._material.dilatation)
        self._mean.give(self._pockets.cell_pressures())
        b = self.forms.residual()
        b += self._mean.forces()
        return b

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the derivative of the residual."""
        self.forms.assemble_jacobian(A)
        self._mean.add_tangent(A)

    def coupled_products(self) -> list[Product]:
        """Return the products of the Jacobian of full pockets of trapped liquid."""
        return [self._pockets.stiffness.add_product]

    def improve_pressures(self) -> bool:
        """Take the present pressures for the multipliers; return whether any cell has one."""
        if self._mean.iterates:
            self._mean.improve()
        return self._mean.iterates

    def mean_stress(self) -> FloatArray:
        """Return the pressures of the cells [Pa], shape (cells,)."""
        return self._mean.pressure

    def nodal_pressure(self) -> FloatArray:
        """Return means of the pressure round the local nodes [Pa], shape (nodes,); collective."""
        self.update()
        stress = cell_stress(self._material, self.mean_stress())
        return nodal_mean(self._unknowns.mesh, stress[:, :3].mean(axis=1))

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
            True: the multipliers are better ones.
        """
        self._material.commit(self.mean_stress(), self._pockets.hold_volume)
        self._mean.commit()
        self._pockets.commit(self.nodal_pressure, self._material.dilatation)
        return True

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self._material.rewind()
        self._pockets.rewind()
        self._mean.rewind()

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return history, multipliers and trapped liquid."""
        pockets = self._pockets.stateful_parts()
        return {"points": self._material, "mean_dilatation": self._mean, **pockets}


class MeanDilatation:
    """Pressures of the cells of one body, from their mean dilatation, and their forces.

    Args:
        body: mesh of the body.
        cells: functions constant in each cell.
        space: displacements (and the axial strain) of the body.
        strain: ε of the trial functions of `space`.
        dx: weighted measure of the points.
        shear_modulus: largest shear modulus of the body [Pa].
    """

    def __init__(
        self,
        body: BodyMesh,
        cells: fem.FunctionSpace,
        space: fem.FunctionSpace,
        strain: Any,
        dx: kinematics.WeightedMeasure,
        shear_modulus: float,
    ) -> None:
        self._numbering = body.cell_numbering
        self._dilatation = fem.form(momentum.dilatation(strain, ufl.TestFunction(cells), dx))
        self._varies = bool(self._dilatation.ufcx_form.num_coefficients)
        self._matrix = create_matrix(self._dilatation)
        self._assemble()
        self._smallest = SMALLEST_COMPRESSIBILITY / shear_modulus
        self._owned = cells.dofmap.index_map.size_local
        self._volumes = fem.assemble_vector(
            fem.form(ufl.TestFunction(cells) * dx)
        ).array[: self._owned].copy()
        count = self._owned + cells.dofmap.index_map.num_ghosts
        self._multiplier = np.zeros(count)
        self._committed = np.zeros(count)
        self._compressibility = np.ones(count)
        self._free = np.zeros(count)
        self.given: BoolArray = np.zeros(count, dtype=bool)
        self.pressure: FloatArray = np.zeros(count)
        self._cell_values = self._matrix.createVecLeft()
        self._forces = self._matrix.createVecRight()

    def _assemble(self) -> None:
        """Assemble ∫ ∇·u of the cells, in which the melt keeps its thickness."""
        self._matrix.zeroEntries()
        assemble_matrix(self._matrix, self._dilatation)
        self._matrix.assemble()

    def begin(
        self,
        compressibility: FloatArray,
        free: FloatArray,
        given: FloatArray,
    ) -> None:
        """Set the volumes of a trial step; collective.

        Args:
            compressibility: c of the cells [1/Pa], shape (cells,).
            free: volumetric strain without pressure, shape (cells,).
            given: pressures of trapped liquid [Pa], nan elsewhere, shape (cells,).
        """
        self.given = ~np.isnan(given)
        # Nor has a given pressure a multiplier.
        self._compressibility = np.where(self.given, self._smallest, compressibility)
        self._free = free.copy()
        if self._varies:
            self._assemble()

    def update(self, dilatation: FloatArray) -> None:
        """Find the pressures for volumetric strains of the cells, shape (cells,)."""
        c, least = self._compressibility, self._least()
        found = (dilatation - self._free + (least - c) * self._multiplier) / least
        self.pressure = np.where(self.given, self.pressure, found)

    def give(self, pressures: FloatArray) -> None:
        """Take the pressures of trapped liquid [Pa], nan elsewhere, shape (cells,)."""
        self.pressure = np.where(self.given, pressures, self.pressure)

    def _least(self) -> FloatArray:
        return np.maximum(self._compressibility, self._smallest)

    def improve(self) -> None:
        """Take the present pressures for the multipliers."""
        self._multiplier = self.pressure.copy()

    @property
    def iterates(self) -> bool:
        """Whether any cell of this rank is so little compressible that it has a multiplier."""
        return bool((self._compressibility < self._least()).any())

    def forces(self) -> FloatArray:
        """Return ∫ p ∇·η of the owned unknowns [N]."""
        return self.forces_of(self.pressure)

    def forces_of(self, pressure: FloatArray) -> FloatArray:
        """Return the forces of other pressures of the cells [Pa], shape (cells,); collective."""
        self._cell_values.array[:] = pressure[: self._owned]
        self._matrix.multTranspose(self._cell_values, self._forces)
        forces: FloatArray = self._forces.array_r.copy()
        return forces

    def add_tangent(self, A: PETSc.Mat) -> None:
        """Add the derivative of `forces` to a matrix that has its entries."""
        scaled = self._matrix.copy()
        free = ~self.given[: self._owned]
        self._cell_values.array[:] = free / (self._volumes * self._least()[: self._owned])
        scaled.diagonalScale(self._cell_values, None)
        product = self._matrix.transposeMatMult(scaled)
        A.axpy(1.0, product, structure=PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        for item in (scaled, product):
            item.destroy()

    def commit(self) -> None:
        """Make the present pressures the multipliers with which the next step starts."""
        self._multiplier = self.pressure.copy()
        self._committed = self._multiplier

    def rewind(self) -> None:
        """Return to the multipliers of the last accepted step; collective."""
        self._multiplier = self._committed
        if self._varies:
            self._assemble()

    def saved(self) -> dict[str, Saved]:
        """Return the multipliers of the last accepted step."""
        return {"multiplier": Saved(self._committed.copy(), self._numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Take back the multipliers of the last accepted step."""
        self._committed = arrays["multiplier"].copy()
        self.pressure = self._committed.copy()
        self.rewind()

    def destroy(self) -> None:
        """Free matrix and vectors."""
        for item in (self._matrix, self._cell_values, self._forces):
            item.destroy()
