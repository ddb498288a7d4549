"""Common part of the formulations of the momentum balance: unknowns, assembled forms, protocol.

A formulation says how the pressure enters: as an unknown of the nodes (`castx.mechanics.mixed`), as
a constant of each cell (`castx.mechanics.q1p0`) or not at all (`castx.mechanics.displacement`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.arrays import FloatArray
from castx.domain.measures import extent
from castx.domain.mesh import BodyMesh
from castx.form_rows import FormRows
from castx.forms import kinematics, momentum
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.constitutive.thickness import Thickness
from castx.mechanics.midsides.midsides import Midsides
from castx.mechanics.mush.wall import WallMelt
from castx.stateful import Stateful

PRESSURE_SHARE = 0.1
"""Unit of the pressure unknown in G/L; with 1 a liquid costs multigrid a fifth more iterations."""

Product = Callable[[FloatArray, FloatArray], None]
"""Adds a matrix times its first argument to its second one; both are owned unknowns of a body."""


class BodyUnknowns:
    """The unknowns of the nodes of one body.

    They are the displacement, in the mixed formulation the pressure over `pressure_scale`, and in
    generalised plane strain the axial strain times `length`: lengths all, so that all rows of the
    residual are forces.

    Args:
        body: mesh of the body.
        model: geometric model.
        with_pressure: whether the pressure is an unknown.
        shear_modulus: largest shear modulus of the body [Pa].
        quadratic: whether mid-sides have a displacement of their own.

    Attributes:
        midsides: unknowns of the mid-sides; None: the displacement is linear.
        dimension: number of the displacement components, which come first.
        pressure_component: number of the pressure, if it is an unknown.
        axial: number of the axial strain, if it is one.
        block_size: unknowns of a node.
        space: function space of the unknowns.
        solution: present values of the unknowns.
        length: largest edge of the box round the body [m].
        pressure_scale: pressure that is one in the unknowns [Pa/m].
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        with_pressure: bool,
        shear_modulus: float,
        quadratic: bool = False,
    ) -> None:
        self.mesh, self.model = body, model
        self.midsides = Midsides(body, model) if quadratic else None
        self.dimension: int = body.mesh.geometry.dim
        self.pressure_component = self.dimension if with_pressure else None
        displaced = self.dimension + int(with_pressure)
        self.axial = displaced if model == "generalised-plane-strain" else None
        self.block_size = displaced + int(self.axial is not None)
        self.space = fem.functionspace(body.mesh, ("Lagrange", 1, (self.block_size,)))
        self.solution = fem.Function(self.space, name=f"motion of {body.name}")
        self.length = extent(body.mesh)
        stiffness = shear_modulus / self.length
        self.pressure_scale = PRESSURE_SHARE * stiffness
        # Constants: forms are compiled once for all values.
        self._pressure_unit = fem.Constant(body.mesh, np.float64(self.pressure_scale))
        self._unit_length = fem.Constant(body.mesh, np.float64(self.length))

    @property
    def owned(self) -> int:
        """Number of unknowns that this rank owns."""
        return int(self.space.dofmap.index_map.size_local) * self.block_size

    def displacement(self, w: Any) -> Any:
        """Return the displacement in unknowns or in a test or trial function w."""
        return ufl.as_vector([w[i] for i in range(self.dimension)])

    def pressure(self, w: Any) -> Any:
        """Return the pressure [Pa] in unknowns or in a test or trial function w."""
        return self._pressure_unit * w[self.pressure_component]

    def axial_strain(self, w: Any) -> Any:
        """Return e of generalised plane strain in unknowns or in a test or trial function w."""
        return w[self.axial] / self._unit_length

    def strain(self, w: Any, follows: Any = 1.0, kept: Any = 0.0) -> Any:
        """Return the strain of unknowns or of a test or trial function, shape (3, 3).

        In plane stress ε_zz is missing: the constitutive law finds it.

        Args:
            w: unknowns, or a test or trial function.
            follows: χ in ε_zz = χ e + `kept` of generalised plane strain.
            kept: part of ε_zz that does not change in a step; none of a test or trial function.
        """
        axial = 0.0 if self.axial is None else follows * self.axial_strain(w) + kept
        x = ufl.SpatialCoordinate(self.mesh.mesh)
        return kinematics.strain(self.displacement(w), self.model, x, axial)

    def total_strain(self, thickness: Thickness) -> Any:
        """Return the strain of the present unknowns, of the mid-sides too, shape (3, 3)."""
        total = self.strain(self.solution, thickness.follows, thickness.kept)
        if self.midsides is not None:
            total += self.midsides.strain(self.midsides.solution)
        return total

    def held(self, thickness: Thickness, dx: Any) -> tuple[Any, Any] | None:
        """Return the work that holds e while nothing is solid, and its derivative, if any does."""
        if thickness.hold is None:
            return None
        e = self.axial_strain
        test, trial = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        change = e(self.solution) - thickness.start
        return (
            momentum.held_strain_work(e(test), change, thickness.hold, dx),
            momentum.held_strain_work(e(test), e(trial), thickness.hold, dx),
        )


class WeakForms:
    """Assembles internal forces, loads, springs and Jacobian of one body from their weak forms.

    Args:
        unknowns: of the body, or of its mid-sides.
        internal: virtual work of the internal forces at `unknowns.solution`.
        jacobian: its derivative for a change of the unknowns.
        load: virtual work of the loads.
        backing: work of a variation against springs behind surfaces that a displacement strains,
            which the first two lack; None: there are none.
        held: work of `BodyUnknowns.held` and its derivative, which they lack too.
    """

    def __init__(
        self,
        unknowns: BodyUnknowns | Midsides,
        internal: Any,
        jacobian: Any,
        load: Any,
        backing: Callable[[Any, Any], Any] | None = None,
        held: tuple[Any, Any] | None = None,
    ) -> None:
        if held is not None:
            internal, jacobian = internal + held[0], jacobian + held[1]
        self._springs: fem.Form | None = None
        if backing is not None:
            u, space = unknowns.displacement, unknowns.space
            eta, du = u(ufl.TestFunction(space)), u(ufl.TrialFunction(space))
            strained = backing(eta, u(unknowns.solution))
            internal, jacobian = internal + strained, jacobian + backing(eta, du)
            self._springs = fem.form(strained)
        self._internal, self._jacobian = fem.form(internal), fem.form(jacobian)
        self._load = fem.form(load)
        self._rows: FormRows | None = None
        index_map, self._owned = unknowns.space.dofmap.index_map, unknowns.owned
        self._row = la.vector(index_map, unknowns.block_size)
        self.load: FloatArray = np.zeros(self._owned)

    def update_load(self) -> None:
        """Assemble the loads at their present values; collective."""
        self.load = self.assemble(self._load)

    def residual(self) -> FloatArray:
        """Return internal minus external forces of the owned unknowns [N]; collective."""
        return self.assemble(self._internal) - self.load

    def spring_forces(self) -> FloatArray:
        """Return the spring forces at the present owned unknowns [N]; collective."""
        return np.zeros(self._owned) if self._springs is None else self.assemble(self._springs)

    def assemble(self, form: fem.Form) -> FloatArray:
        """Return the owned rows of a linear form on the unknowns; collective."""
        b = self._row
        b.array[:] = 0
        fem.assemble_vector(b.array, form)
        b.scatter_reverse(la.InsertMode.add)
        return b.array[: self._owned].copy()

    def create_jacobian(self) -> PETSc.Mat:
        """Return an unassembled matrix for `assemble_jacobian`."""
        return create_matrix(self._jacobian)

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the derivative of the internal forces and the springs."""
        if self._rows is None:
            self._rows = FormRows(self._jacobian)
        self._rows.assemble(A)


class MidsideForms(WeakForms):
    """Assembles the balance of the mid-sides and its coupling with the nodes.

    Args:
        midsides: of the body.
        internal: virtual work of the internal forces for bubbles.
        jacobian: its derivative for a change of the bubbles.
        load: virtual work of the loads for bubbles.
        coupling: derivative of `internal` for a change of the unknowns of the nodes; its transpose
            is that of the rows of the nodes for a change of the bubbles.
    """

    def __init__(
        self, midsides: Midsides, internal: Any, jacobian: Any, load: Any, coupling: Any
    ) -> None:
        super().__init__(midsides, internal, jacobian, load)
        self._coupling = fem.form(coupling)

    def create_coupling(self) -> PETSc.Mat:
        """Return an unassembled matrix for `assemble_coupling`."""
        return create_matrix(self._coupling)

    def assemble_coupling(self, A: PETSc.Mat) -> None:
        """Assemble the coupling."""
        A.zeroEntries()
        assemble_matrix(A, self._coupling)
        A.assemble()


class Formulation(ABC):
    """The momentum balance of one body, with its pressure treated in one way.

    A formulation without liquid and without multipliers has nothing to say beyond the abstract
    methods.

    Attributes:
        forms: compiled weak forms of the balance.
        midside_forms: those of the mid-sides; None: the displacement is linear.
        wall_melt: melt at its walls that flows through its mush; None: none does.
    """

    forms: WeakForms
    midside_forms: MidsideForms | None = None
    wall_melt: WallMelt | None = None

    @abstractmethod
    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Find trapped liquid and the like for a trial step, behind its material; collective.

        Args:
            temperature: at the local nodes [°C], shape (nodes,).
            solid_fraction: likewise.
        """

    @abstractmethod
    def update(self) -> None:
        """Find stresses and tangents at the present unknowns.

        Raises:
            ConvergenceError: the law cannot be solved at some point; on its own rank alone.
        """

    def update_load(self) -> None:
        """Assemble the loads at their present values; collective."""
        self.forms.update_load()

    @abstractmethod
    def residual(self) -> FloatArray:
        """Return internal minus external forces for the stresses of `update`; collective."""

    def midside_residual(self) -> FloatArray:
        """Return the forces on the mid-sides, after those on the nodes; collective."""
        return np.zeros(0)

    @abstractmethod
    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the derivative of the residual, without `products`."""

    def products(self) -> list[Product]:
        """Return the parts of the Jacobian on pressures that are applied without a matrix."""
        return []

    def matrix_of_products(self) -> PETSc.Mat | None:
        """Return the sum of `products` as a matrix of one pattern; None: it is not known.

        The caller destroys it; collective.
        """
        return None

    def coupled_products(self) -> list[Product]:
        """Return products of matrices with displacements beside the assembled Jacobian."""
        return []

    def improve_pressures(self) -> bool:
        """Take the pressures of this rank for the multipliers; return whether there are any."""
        return False

    @property
    def pores_changed(self) -> bool:
        """Whether pores on this rank have opened or closed at the iterate of the last call."""
        return False

    @abstractmethod
    def mean_stress(self) -> FloatArray:
        """Return the mean stress of the cells for the stresses of `update` [Pa], shape (cells,)."""

    def point_pressure(self) -> FloatArray | None:
        """Return the mean stress of the points [Pa], (points,); None: that of their cells."""
        return None

    @abstractmethod
    def nodal_pressure(self) -> FloatArray:
        """Return the pressure at the local nodes [Pa], shape (nodes,); collective."""

    @property
    def has_pockets(self) -> bool:
        """Whether there is trapped liquid in the trial step, whose pores may open and close."""
        return False

    def liquid_totals(self) -> dict[str, float] | None:
        """Return feeding demand, pores and pressure; None for a body that never is a liquid."""
        return None

    def pores(self) -> FloatArray | None:
        """Return the pores of the cells after the last accepted step, (cells,); None: no void."""
        return None

    @abstractmethod
    def commit(self) -> bool:
        """Accept the trial state as the start of the next step; collective.

        Returns:
            Whether the residual at the same unknowns is another one from now on.
        """

    @abstractmethod
    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""

    @abstractmethod
    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the parts of the body that a checkpoint keeps, by their name there."""


def cell_stress(material: MaterialPoints, mean: FloatArray) -> FloatArray:
    """Return σ = p 1 + s of the cells [Pa], shape (cells, 6): xx, yy, zz, xy, xz, yz.

    Args:
        material: gives the deviatoric stress s of its last update.
        mean: mean stress p [Pa], shape (cells,).
    """
    deviator = material.points.cell_means(material.response.stress)
    stress = np.zeros((len(deviator), 6))
    stress[:, : deviator.shape[1]] = deviator
    stress[:, :3] += mean[:, None]
    return stress
