"""Discrete balance of momentum of one body: spaces, forms, state and loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.constitutive import BirthHistory, CellState
from castx.constraints import FixedDirections
from castx.forms import kinematics, momentum, stabilisation
from castx.measures import cell_measure, extent, surface_measure
from castx.mechanical_body import MechanicalBody
from castx.mesh import BodyMesh
from castx.pockets import Pockets
from castx.projection import Projection
from castx.tables import Table

FloatArray = npt.NDArray[np.float64]


PRESSURE_SHARE = 0.1
"""Unit of the pressure unknown in G/L; with 1 a liquid costs multigrid a fifth more iterations."""

TRAPPED_SHARE = 1e-6
"""Weight of the equation p = p_trapped inside trapped liquid, in units of the solid's 1/K."""


class BodyMechanics:
    """Residual and Jacobian of one body, its displacement and its history.

    The unknown has the displacement and, in the mixed formulation, the pressure over
    `pressure_scale` at each node, which makes a length of it and forces of all rows.

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
        self.name = body.name
        self.mesh = body
        self.model = model
        self.description = description
        self.dimension: int = body.mesh.geometry.dim
        self.mixed = description.formulation == "mixed"
        self.block_size = self.dimension + int(self.mixed)
        self.space = fem.functionspace(body.mesh, ("Lagrange", 1, (self.block_size,)))
        self.solution = fem.Function(self.space, name=f"motion of {body.name}")
        stiffness = description.law.largest_shear_modulus() / extent(body.mesh)
        self.pressure_scale = PRESSURE_SHARE * stiffness
        # A constant: forms are compiled once for all values.
        self._pressure_unit = fem.Constant(body.mesh, np.float64(self.pressure_scale))
        self.cell_nodes = body.nodes.dofmap.list
        self.coherent: npt.NDArray[np.bool_] = np.ones(len(self.cell_nodes), dtype=bool)
        self._create_state()
        self._create_loads()
        self._create_forms()
        self._residual = la.vector(self.space.dofmap.index_map, self.block_size)
        self.projection = None
        if self._uses_osgs:
            self.projection = Projection(body, model, self.tau, self.pressure_scale, planes)

    @property
    def _uses_osgs(self) -> bool:
        return self.mixed and self.description.stabilisation == "osgs"

    def _create_state(self) -> None:
        mesh = self.mesh.mesh
        components = 6 if self.model == "3d" else 4
        constant = fem.functionspace(mesh, ("DG", 0))
        self._shear_modulus = fem.Function(constant)
        self._compressibility = fem.Function(constant)
        self._thermal_strain = fem.Function(constant)
        tensor = fem.functionspace(mesh, ("DG", 0, (components,)))
        self._reference_strain = fem.Function(tensor)
        self._cell_tensor = fem.Function(tensor)
        self._history = BirthHistory(len(self.cell_nodes), components)
        self.pockets: Pockets | None = None
        if self.mixed and self.description.law.material.liquid is not None:
            self.pockets = Pockets(self.mesh, self.model, self.description.closed)
        if self.description.starts_liquid:
            self._history.begin_liquid()

    def _create_loads(self) -> None:
        mesh = self.mesh.mesh
        force = self.description.body_force
        if callable(force):
            self.body_force = force(ufl.SpatialCoordinate(mesh))
        else:
            components = np.zeros(self.dimension)
            components[: len(force)] = force[: self.dimension]
            self.body_force = fem.Constant(mesh, components)
        self._load_values: list[tuple[fem.Constant, tuple[Table, ...]]] = []
        for load in self.description.loads:
            tables = load.traction if load.pressure is None else (load.pressure,)
            assert tables is not None
            none = np.zeros(len(tables)) if load.pressure is None else np.float64(0.0)
            self._load_values.append((fem.Constant(mesh, none), tables))

    def _create_forms(self) -> None:
        mesh, model = self.mesh.mesh, self.model
        x = ufl.SpatialCoordinate(mesh)
        w, z = self.solution, ufl.TestFunction(self.space)
        u, p = self.split(w)
        eta, q = self.split(z)
        self._cell_state = momentum.ElasticState(
            self._shear_modulus,
            self._compressibility,
            self._thermal_strain,
            kinematics.symmetric_tensor(self._reference_strain, model),
        )
        if self.pockets is not None:
            self._cell_state = self._cell_state._replace(
                trapped=self.pockets.trapped, trapped_pressure=self.pockets.pressure
            )
        # Plane stress puts p into the strain: both must then be integrated alike.
        dx = cell_measure(self.mesh, model, 2 if model == "plane-stress" and self.mixed else 1)
        dx_p = cell_measure(self.mesh, model, 2)
        if self.mixed:
            # A given pressure needs no stabilisation.
            self.tau = (1 - self._cell_state.trapped) * stabilisation.tau(
                self._shear_modulus,
                stabilisation.element_length(mesh, self.dimension),
                stabilisation.CONSTANTS[self.description.stabilisation],
            )
            F = momentum.mixed_internal_virtual_work(
                u, p, eta, q, self._cell_state, model, x, dx, dx_p
            )
            F -= stabilisation.pressure_laplacian(p, q, self.tau, dx_p)
            if not self._uses_osgs:
                F -= stabilisation.body_force_residual(q, self.body_force, self.tau, dx_p)
        else:
            F = momentum.displacement_internal_virtual_work(
                u, eta, self._cell_state, model, x, dx
            )
        self._jacobian_form = fem.form(ufl.derivative(F, w))
        F -= momentum.body_force_work(eta, self.body_force, dx_p)
        F -= self._surface_work(eta)
        self._residual_form = fem.form(F)
        self._create_cell_expressions(x)

    def _surface_work(self, eta: Any) -> Any:
        ds = surface_measure(self.mesh, self.model, 2)
        normal = ufl.FacetNormal(self.mesh.mesh)
        work = ufl.inner(ufl.zero(self.dimension), eta) * ds
        for load, (value, _) in zip(self.description.loads, self._load_values, strict=True):
            measure = ds(self.mesh.surfaces[load.surface])
            if load.pressure is not None:
                work += momentum.pressure_work(eta, value, normal, measure)
            else:
                work += momentum.traction_work(eta, value, measure)
        return work

    def _create_cell_expressions(self, x: Any) -> None:
        u, p = self.split(self.solution)
        model, state = self.model, self._cell_state
        if self.mixed:
            total = momentum.mixed_strain(u, p, state, model, x)
            stress = momentum.deviatoric_stress(total, state) + p * ufl.Identity(3)
        else:
            # A displacement body has no liquid, so its history does not use the strain.
            total = kinematics.strain(u, model, x)
            stress = momentum.displacement_stress(u, state, model, x)
        points = self._cell_tensor.function_space.element.interpolation_points()
        strain = kinematics.symmetric_components(total, model)
        self._strain_expression = fem.Expression(strain, points)
        self._stress_expression = fem.Expression(
            kinematics.symmetric_components(stress, model), points
        )

    def split(self, w: Any) -> tuple[Any, Any]:
        """Return displacement and pressure [Pa] of an unknown or a test function."""
        if not self.mixed:
            return w, None
        u = ufl.as_vector([w[i] for i in range(self.dimension)])
        return u, self._pressure_unit * w[self.dimension]

    def set_time(self, time: float) -> None:
        """Set the loads to those at a time [s]."""
        for constant, tables in self._load_values:
            values = np.array([float(table(time)) for table in tables])
            constant.value = values if constant.value.ndim else values[0]

    def update_state(
        self, temperature: FloatArray, solid_fraction: FloatArray, step: float
    ) -> CellState:
        """Evaluate the law for a trial step.

        Args:
            temperature: at the local nodes [°C], shape (nodes,).
            solid_fraction: likewise.
            step: time step [s].
        """
        nodes = self.cell_nodes
        state = self.description.law.evaluate(temperature[nodes], solid_fraction[nodes], step)
        self._shear_modulus.x.array[:] = state.shear_modulus
        self._compressibility.x.array[:] = state.compressibility
        self._thermal_strain.x.array[:] = state.thermal_strain
        self._reference_strain.x.array[:] = self._history.reference(state.coherent).ravel()
        self.coherent = state.coherent
        if self.pockets is not None:
            trapped = self.pockets.update(~state.coherent)
            # Little enough to leave the pressures of the shell alone.
            share = TRAPPED_SHARE * state.solid_compressibility[trapped]
            self._compressibility.x.array[trapped] = share
        if self.projection is not None:
            self.projection.assemble()
        return state

    def residual(self) -> FloatArray:
        """Return internal minus external forces of the owned unknowns."""
        b = self._assemble(self._residual_form)
        if self.projection is not None:
            b[self.dimension :: self.block_size] += self.projection.correction(
                self.solution.x.array[self.dimension :: self.block_size]
            )
        return b

    def _assemble(self, form: fem.Form) -> FloatArray:
        b = self._residual
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

    def nodal_pressure(self) -> FloatArray:
        """Return the pressure at the local nodes [Pa], shape (nodes,)."""
        if not self.mixed:
            return self.nodal_mean(self.stress()[:, :3].mean(axis=1))
        scaled = self.solution.x.array[self.dimension :: self.block_size]
        return np.asarray(self.pressure_scale * scaled)

    def stress(self) -> FloatArray:
        """Return the stress in the cells [Pa], shape (cells, 6): xx, yy, zz, xy, xz, yz."""
        self._cell_tensor.interpolate(self._stress_expression)
        components = self._history.reference(self.coherent).shape[1]
        stress = np.zeros((len(self.cell_nodes), 6))
        stress[:, :components] = self._cell_tensor.x.array.reshape(-1, components)
        return stress

    def nodal_mean(self, values: FloatArray) -> FloatArray:
        """Return the means over the cells round each local node of cell values, shape (nodes,)."""
        sums = la.vector(self.mesh.nodes.dofmap.index_map, 2)
        sums.array[:] = 0
        cells = self.mesh.mesh.topology.index_map(self.mesh.mesh.topology.dim).size_local
        nodes = self.cell_nodes[:cells].ravel()
        corners = self.cell_nodes.shape[1]
        np.add.at(sums.array.reshape(-1, 2)[:, 0], nodes, np.repeat(values[:cells], corners))
        np.add.at(sums.array.reshape(-1, 2)[:, 1], nodes, 1.0)
        sums.scatter_reverse(la.InsertMode.add)
        sums.scatter_forward()
        total, count = sums.array.reshape(-1, 2).T
        return np.asarray(total / count)

    def commit(self) -> None:
        """Make the trial state the one from which the next step starts."""
        self._cell_tensor.interpolate(self._strain_expression)
        strain = self._cell_tensor.x.array.reshape(len(self.cell_nodes), -1).copy()
        dilatation = strain[:, :3].sum(axis=1)
        strain[:, :3] -= dilatation[:, None] / 3
        self._history.commit(self.coherent, strain)
        if self.pockets is not None:
            self.pockets.commit(self.nodal_pressure(), dilatation)
