"""Discrete balance of momentum of one body: spaces, forms, state and residual."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.arrays import FloatArray
from castx.domain.measures import extent, nodal_sum
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics
from castx.mechanics.constitutive.integration_points import IntegrationPoints, quadrature_degree
from castx.mechanics.constitutive.law import ELASTIC
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.forms import BodyForms
from castx.mechanics.loads import BodyLoads
from castx.mechanics.osgs import Projection
from castx.mechanics.q1p0 import MeanDilatation
from castx.mechanics.trapped_liquid import Pockets

PRESSURE_SHARE = 0.1
"""Unit of the pressure unknown in G/L; with 1 a liquid costs multigrid a fifth more iterations."""

TRAPPED_SHARE = 1e-6
"""Weight of the equation p = p_trapped inside trapped liquid, in units of the solid's 1/K."""

THERMAL_SHARE = 1e-4
"""Part of the stress of a hindered thermal strain that counts as an internal force of the body."""


class BodyMechanics:
    """Residual and Jacobian of one body, its displacement and its history.

    The unknowns of a node are the displacement, in the mixed formulation the pressure over
    `pressure_scale`, and in generalised plane strain the axial strain times `length`: lengths all,
    so that all rows are forces.

    Args:
        body: mesh of the body.
        model: geometric model.
        description: law, formulation and loads.
        planes: symmetry planes, behind which the body goes on as its mirror image.
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        description: MechanicalBody,
        planes: Sequence[FixedDirections] = (),
    ) -> None:
        self.name, self.mesh, self.model = body.name, body, model
        self.description = description
        self.dimension: int = body.mesh.geometry.dim
        self.mixed = description.formulation == "mixed"
        axial = model == "generalised-plane-strain"
        self.axial = self.dimension + int(self.mixed) if axial else None
        self.block_size = self.dimension + int(self.mixed) + int(axial)
        self.space = fem.functionspace(body.mesh, ("Lagrange", 1, (self.block_size,)))
        self.solution = fem.Function(self.space, name=f"motion of {body.name}")
        self.length = extent(body.mesh)
        stiffness = description.law.largest_shear_modulus() / self.length
        self.pressure_scale = PRESSURE_SHARE * stiffness
        # Constants: forms are compiled once for all values.
        self._pressure_unit = fem.Constant(body.mesh, np.float64(self.pressure_scale))
        self._unit_length = fem.Constant(body.mesh, np.float64(self.length))
        self.cell_nodes = body.nodes.dofmap.list
        self.loads = BodyLoads(body, model, description)
        self._create_points()
        self._create_forms()
        self._row = la.vector(self.space.dofmap.index_map, self.block_size)
        self._load = np.zeros(self.space.dofmap.index_map.size_local * self.block_size)
        self.projection = None
        if self._uses_osgs:
            self.projection = Projection(body, model, self.tau, self.pressure_scale, planes)

    @property
    def _uses_osgs(self) -> bool:
        return self.mixed and self.description.stabilisation == "osgs"

    @property
    def is_linear(self) -> bool:
        """Whether the Jacobian is the same for all displacements of a step."""
        return self.description.law.is_linear

    @property
    def dissipated_fraction(self) -> float:
        """Part of the plastic work that becomes heat; zero for a body that cannot flow."""
        law = self.description.law
        return 0.0 if law.name == ELASTIC else law.material.dissipation

    @property
    def owned_nodes(self) -> int:
        """Number of nodes that this rank owns."""
        return int(self.mesh.nodes.dofmap.index_map.size_local)

    def _create_points(self) -> None:
        given = self.description
        degree = quadrature_degree(self.mesh, self.model, given.formulation)
        self.points = IntegrationPoints(self.mesh, self.model, degree)
        self.cells = fem.functionspace(self.mesh.mesh, ("DG", 0))
        self.material = MaterialPoints(self.points, given.law, self.cells, given.starts_liquid)
        self.pockets: Pockets | None = None
        if not self.is_compressible and given.formulation != "displacement":
            self.pockets = Pockets(self.mesh, self.model, given.closed, given.body_force)

    @property
    def is_compressible(self) -> bool:
        """Whether the body never is a liquid."""
        return self.description.law.material.liquid is None

    def _create_forms(self) -> None:
        forms = BodyForms(self)
        self.tau = forms.tau
        self._internal_form = fem.form(forms.internal)
        self._jacobian_form = fem.form(forms.jacobian)
        self._load_form = fem.form(forms.load)
        components = kinematics.symmetric_components(forms.total, self.model)
        self._strain_expression = self.points.expression(components)
        self._pressure_expression = None
        if self.mixed:
            self._pressure_expression = self.points.expression(forms.pressure)
        self.mean_dilatation: MeanDilatation | None = None
        if self.description.formulation == "q1p0":
            self.mean_dilatation = MeanDilatation(
                self.mesh, self.cells, self.space, forms.increment, forms.dx,
                self.description.law.largest_shear_modulus(),
            )  # fmt: skip
        self._force_of_stress = self.points.weights.sum(axis=1) / self.points.sizes

    def split(self, w: Any) -> tuple[Any, Any]:
        """Return displacement and pressure [Pa] of an unknown or a test function."""
        u = ufl.as_vector([w[i] for i in range(self.dimension)])
        return u, self._pressure_unit * w[self.dimension] if self.mixed else None

    def strain(self, w: Any) -> Any:
        """Return the strain of an unknown or a test function, in plane stress that in the plane."""
        axial = 0.0 if self.axial is None else w[self.axial] / self._unit_length
        x = ufl.SpatialCoordinate(self.mesh.mesh)
        return kinematics.strain(self.split(w)[0], self.model, x, axial)

    def set_time(self, time: float) -> None:
        """Set the loads to those at a time [s]."""
        self.loads.set_time(time)
        self._load = self._assemble(self._load_form)

    def update_state(
        self, temperature: FloatArray, solid_fraction: FloatArray, step: float
    ) -> None:
        """Evaluate the law for a trial step.

        Args:
            temperature: at the local nodes [°C], shape (nodes,).
            solid_fraction: likewise.
            step: time step [s].
        """
        conditions = self.material.begin(temperature, solid_fraction, step)
        given = None
        if self.pockets is not None:
            trapped = self.pockets.update(~conditions.coherent)
            conditions = self.material.add_free_volume(self.pockets.birth_volume)
            given = np.where(
                trapped, self.pockets.pressure.x.array[self.cell_nodes].mean(axis=1), np.nan
            )
            # Little enough to leave the pressures of the shell alone.
            share = TRAPPED_SHARE * conditions.solid_compressibility[trapped]
            self.material.compressibility.x.array[trapped] = share
        if self.mean_dilatation is not None:
            self.mean_dilatation.begin(conditions, given)
        if self.projection is not None:
            self.projection.assemble()

    @property
    def coherent(self) -> Any:
        """Whether the cells are solid in the trial step, shape (cells,)."""
        return self.material.conditions.coherent

    def residual(self) -> FloatArray:
        """Return internal minus external forces of the owned unknowns.

        Raises:
            ConvergenceError: the law cannot be solved at some point; on its own rank alone.
        """
        self.update_points()
        return self.present_residual()

    def present_residual(self) -> FloatArray:
        """Return the residual for the stresses that `update_points` found; collective."""
        b = self._assemble(self._internal_form) - self._load
        if self.mean_dilatation is not None:
            b += self.mean_dilatation.forces()
        if self.projection is not None:
            b[self.dimension :: self.block_size] += self.projection.correction(
                self.solution.x.array[self.dimension :: self.block_size]
            )
        return b

    def update_points(self) -> None:
        """Find stress and tangent at the present displacement and pressure.

        Raises:
            ConvergenceError: the law cannot be solved at some point; on its own rank alone.
        """
        strain = self.points.evaluate(self._strain_expression)
        pressure = None
        if self._pressure_expression is not None:
            pressure = self.points.evaluate(self._pressure_expression)[:, 0]
        self.material.update(strain, pressure)
        if self.mean_dilatation is not None:
            self.mean_dilatation.update(self.material.dilatation)

    def _assemble(self, form: fem.Form) -> FloatArray:
        b = self._row
        b.array[:] = 0
        fem.assemble_vector(b.array, form)
        b.scatter_reverse(la.InsertMode.add)
        owned = self.space.dofmap.index_map.size_local * self.block_size
        return b.array[:owned].copy()

    def create_jacobian(self) -> PETSc.Mat:
        """Return an unassembled matrix for `assemble_jacobian`."""
        return create_matrix(self._jacobian_form)

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the Jacobian; with OSGS that of GLS, which preconditions it."""
        A.zeroEntries()
        assemble_matrix(A, self._jacobian_form)
        A.assemble()
        if self.mean_dilatation is not None:
            self.mean_dilatation.add_tangent(A)

    def force_scale(self) -> tuple[float, float]:
        """Return sums of squares over the owned nodes of this rank [N²].

        Of what the cells exert on each node, however much of it cancels, and of the loads.
        """
        size = np.linalg.norm(self._present_stress()[:, [0, 1, 2, 3, 4, 5, 3, 4, 5]], axis=1)
        conditions = self.material.conditions
        G = self.points.cell_means(conditions.shear_modulus)
        size += THERMAL_SHARE * 2 * G * np.abs(self.material.thermal_change)
        owned = self.cells.dofmap.index_map.size_local
        corners = self.cell_nodes[:owned]
        forces = np.repeat((size * self._force_of_stress)[:owned], corners.shape[1])
        here = np.bincount(corners.ravel(), forces, len(self.mesh.parent_vertices))
        mine = nodal_sum(self.mesh, here)[: self.owned_nodes]
        return float(mine @ mine), float(self._load @ self._load)

    def nodal_pressure(self) -> FloatArray:
        """Return the pressure at the local nodes [Pa], shape (nodes,)."""
        if not self.mixed:
            return self.nodal_mean(self.stress()[:, :3].mean(axis=1))
        scaled = self.solution.x.array[self.dimension :: self.block_size]
        return np.asarray(self.pressure_scale * scaled)

    def stress(self) -> FloatArray:
        """Return the stress in the cells [Pa], shape (cells, 6): xx, yy, zz, xy, xz, yz."""
        self.update_points()
        return self._present_stress()

    def _present_stress(self) -> FloatArray:
        deviator = self.points.cell_means(self.material.response.stress)
        stress = np.zeros((len(self.cell_nodes), 6))
        stress[:, : deviator.shape[1]] = deviator
        stress[:, :3] += self._mean_stress()[:, None]
        return stress

    def _mean_stress(self) -> FloatArray:
        if self.mean_dilatation is not None:
            return self.mean_dilatation.pressure
        if self.mixed:
            return np.asarray(self.nodal_pressure()[self.cell_nodes].mean(axis=1))
        conditions = self.material.conditions
        change = self.material.dilatation - conditions.thermal_strain
        return change / conditions.compressibility

    def plastic_strain(self) -> FloatArray:
        """Return the equivalent viscoplastic strain of the cells, shape (cells,)."""
        return self.points.cell_means(self.material.response.equivalent)

    def nodal_plastic_power(self) -> FloatArray:
        """Return the power of plastic work at the owned nodes [W], shape (owned,)."""
        count = len(self.mesh.parent_vertices)
        here = self.points.to_nodes(self.material.plastic_power(), count)
        return nodal_sum(self.mesh, here)[: self.owned_nodes]

    def nodal_mean(self, values: FloatArray) -> FloatArray:
        """Return the means over the cells round each local node of cell values, shape (nodes,)."""
        owned = self.cells.dofmap.index_map.size_local
        nodes = self.cell_nodes[:owned].ravel()
        spread = np.repeat(values[:owned], self.cell_nodes.shape[1])
        total, count = (
            nodal_sum(self.mesh, np.bincount(nodes, weights, len(self.mesh.parent_vertices)))
            for weights in (spread, np.ones(len(nodes)))
        )
        return np.asarray(total / count)

    def commit(self) -> None:
        """Make the trial state the one from which the next step starts."""
        self.update_points()
        self.material.commit()
        if self.mean_dilatation is not None:
            self.mean_dilatation.commit()
        if self.pockets is not None:
            self.pockets.commit(self.nodal_pressure(), self.material.dilatation)

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self.material.rewind()
        if self.mean_dilatation is not None:
            self.mean_dilatation.rewind()
