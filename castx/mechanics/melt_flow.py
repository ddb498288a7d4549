"""Flow of melt and stabilisation in the continuity rows of one body: forms, matrix, projection."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import create_matrix

from castx.arrays import BoolArray, FloatArray
from castx.form_rows import FormRows
from castx.forms import mush, stabilisation
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import BodyUnknowns, WeakForms
from castx.mechanics.osgs import OrthogonalProjection


class MeltFlow:
    """Flow to the nodes in a step, Σ_e τ_D ∫ ∇q·(∇p + b) + Σ_e τ_x ∫ ∇q·(∇p - Π).

    Args:
        unknowns: of the body, with the pressure.
        cells: functions constant in each cell.
        tau_e: τ_e of the stabilisation [m²/Pa].
        body_force: b [N/m³], for forms.
        kind: stabilisation, "osgs" or "gls".
        planes: symmetry planes of the body.
        dx: weighted measure, exact for linear p.

    Attributes:
        rows: of the pressures among the unknowns.
    """

    def __init__(
        self,
        unknowns: BodyUnknowns,
        cells: fem.FunctionSpace,
        tau_e: Any,
        body_force: Any,
        kind: str,
        planes: Sequence[FixedDirections],
        dx: Any,
    ) -> None:
        self._unknowns = unknowns
        self.rows = slice(unknowns.pressure_component, None, unknowns.block_size)
        self._tau_d, self._full = fem.Function(cells), fem.Function(cells)
        excess = mush.excess(self._full * tau_e, self._tau_d)
        p = unknowns.pressure(unknowns.solution)
        q = unknowns.pressure(ufl.TestFunction(unknowns.space))
        change = unknowns.pressure(ufl.TrialFunction(unknowns.space))
        if kind == "gls":
            stabilised = mush.darcy_flow(p, q, body_force, excess, dx)
        else:
            stabilised = stabilisation.pressure_laplacian(p, q, excess, dx)
        self._flow = fem.form(mush.darcy_flow(p, q, body_force, self._tau_d, dx))
        self._stabilised = fem.form(stabilised)
        both = fem.form(stabilisation.pressure_laplacian(change, q, self._tau_d + excess, dx))
        self._form_rows, self._matrix = FormRows(both), create_matrix(both)
        self._projection: OrthogonalProjection | None = None
        if kind == "osgs":
            self._projection = OrthogonalProjection(unknowns, excess, planes)

    def begin(self, tau_d: FloatArray, full: FloatArray) -> None:
        """Take over the permeability of a trial step; collective.

        Args:
            tau_d: τ_D of the cells [m²/Pa], shape (cells,).
            full: one where cells hold melt or solid, zero where melt has left, shape (cells,).
        """
        self._tau_d.x.array[:], self._full.x.array[:] = tau_d, full
        self.assemble()

    def assemble(self) -> None:
        """Assemble matrix and projection for the present moduli; collective."""
        self._form_rows.assemble(self._matrix)
        if self._projection is not None:
            self._projection.assemble()

    @property
    def conductance(self) -> FloatArray:
        """Flow to the owned nodes over their pressure [m³/Pa], shape (owned,)."""
        diagonal = self._matrix.getDiagonal()
        found = diagonal.array_r[self.rows] / self._unknowns.pressure_scale**2
        diagonal.destroy()
        return np.asarray(found, dtype=np.float64)

    def _volumes(self, forms: WeakForms, form: fem.Form) -> FloatArray:
        rows = forms.assemble(form)[self.rows] / self._unknowns.pressure_scale
        return np.asarray(rows, dtype=np.float64)

    def drained(self, forms: WeakForms) -> FloatArray:
        """Return the flow to the owned nodes by Darcy's law [m³], shape (owned,); collective."""
        return self._volumes(forms, self._flow)

    def arriving(self, forms: WeakForms) -> FloatArray:
        """Return the same with the stabilisation; collective."""
        projected = self.projected(self._unknowns.solution.x.array)
        found = self.drained(forms) + self._volumes(forms, self._stabilised)
        return np.asarray(found - projected[self.rows] / self._unknowns.pressure_scale)

    def projected(self, x: FloatArray) -> FloatArray:
        """Return the part of OSGS beyond the matrix for owned unknowns x, (owned unknowns,)."""
        found = np.zeros(self._unknowns.owned)
        if self._projection is not None:
            self._projection.add_product(x, found)
        return found

    def add_to(self, A: PETSc.Mat, weight: FloatArray) -> None:
        """Subtract the flow over the weights of the nodes from the Jacobian A; collective.

        Args:
            A: of the body.
            weight: 1 + β f of the owned nodes, shape (owned,).
        """
        shares, flow = A.createVecLeft(), self._matrix.copy()
        shares.array[:] = 0.0
        shares.array[self.rows] = -1.0 / weight
        flow.diagonalScale(shares, None)
        A.axpy(1.0, flow, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        flow.destroy()
        shares.destroy()

    def supply(self, A: PETSc.Mat, nodes: BoolArray, weight: FloatArray) -> FloatArray:
        """Return the derivative of the volume that some nodes ask of a feeder, (owned unknowns,).

        Args:
            A: Jacobian of the body with the rows of all pressures as volumes.
            nodes: whether the owned nodes belong to it, shape (owned,).
            weight: 1 + β f of the owned nodes, shape (owned,).
        """
        chosen, image = A.createVecLeft(), A.createVecRight()
        chosen.array[:] = 0.0
        chosen.array[self.rows] = nodes / self._unknowns.pressure_scale
        projected = self.projected(chosen.array_r.copy())
        chosen.array[self.rows] *= weight
        A.multTranspose(chosen, image)
        found = image.array_r + projected
        chosen.destroy()
        image.destroy()
        return np.asarray(found, dtype=np.float64)
