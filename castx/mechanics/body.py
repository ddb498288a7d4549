"""Mechanics of one body: its formulation, its history, and the stresses that results show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.materials.enthalpy import HeatState
from castx.mechanics.constitutive.granular_points import GranularPoints
from castx.mechanics.constitutive.integration_points import (
    IntegrationPoints,
    VolumePoints,
    quadrature_degree,
)
from castx.mechanics.constitutive.law import ELASTIC
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.darcy import DarcyFormulation
from castx.mechanics.description import MechanicalBody
from castx.mechanics.displacement import DisplacementFormulation
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import BodyUnknowns, Formulation, cell_stress
from castx.mechanics.loads import BodyLoads
from castx.mechanics.mixed import MixedFormulation
from castx.mechanics.q1p0 import Q1P0Formulation
from castx.mechanics.taylor_hood import TaylorHoodFormulation
from castx.mechanics.trapped_liquid import NoPockets, Pockets
from castx.stateful import Stateful

THERMAL_SHARE = 1e-4
"""Part of the stress of a hindered thermal strain that counts as an internal force of the body."""

NOWHERE: FloatArray = np.array([np.nan])
"""Unlike all unknowns, and unlike the empty ones of a rank without a node of the body."""


class BodyMechanics:
    """Residual and Jacobian of one body, its displacement and its history.

    Args:
        body: mesh of the body.
        model: geometric model.
        description: law, formulation and loads.
        planes: symmetry planes, behind which the body goes on as its mirror image.

    Attributes:
        unknowns: displacement, pressure and axial strain of the nodes.
        midsides: unknowns of the mid-sides; None: the displacement is linear.
        loads: external forces.
        points: integration points.
        material: stress and tangent at the integration points.
        formulation: forms and pressures.
        owned_cells: number of cells that this rank owns.
        evaluations: how often the law has been evaluated.
        trials: for how many temperatures and step sizes the material has been evaluated.
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        description: MechanicalBody,
        planes: Sequence[FixedDirections] = (),
    ) -> None:
        self.name, self.mesh, self.model = body.name, body, model
        self.cell_nodes = body.nodes.dofmap.list
        self._law, quadratic = description.law, description.formulation == "taylor-hood"
        self.unknowns = BodyUnknowns(
            body, model, quadratic or description.formulation == "mixed",
            self._law.largest_shear_modulus(), quadratic,
        )  # fmt: skip
        self.midsides = self.unknowns.midsides
        self.dimension, self.block_size = self.unknowns.dimension, self.unknowns.block_size
        self.space, self.solution = self.unknowns.space, self.unknowns.solution
        self.axial, self.length = self.unknowns.axial, self.unknowns.length
        granular = self._law.is_granular
        degree = quadrature_degree(body, model, description.formulation)
        self.loads = BodyLoads(body, model, description, max(2, degree))
        kind = VolumePoints if quadratic or granular else IntegrationPoints
        self.points = kind(body, model, degree)
        cells = fem.functionspace(body.mesh, ("DG", 0))
        self.owned_cells = int(cells.dofmap.index_map.size_local)
        self.material = (
            GranularPoints(self.points, self._law, cells) if granular
            else MaterialPoints(self.points, self._law, cells, description.starts_liquid)
        )  # fmt: skip
        self._force_of_stress = self.points.weights.sum(axis=1) / self.points.sizes
        self.formulation = _formulation(
            self.unknowns, self.material, self.loads, description, cells, planes
        )
        self.evaluations = self.trials = 0
        self._evaluated_at: FloatArray = NOWHERE

    @property
    def is_linear(self) -> bool:
        """Whether the Jacobian is the same for all displacements of a step."""
        return self._law.is_linear and not self.formulation.has_pockets

    @property
    def is_compressible(self) -> bool:
        """Whether the body never is a liquid."""
        return self._law.material.liquid is None

    @property
    def dissipated_fraction(self) -> float:
        """Part of the plastic work that becomes heat; zero for a body that cannot flow."""
        return 0.0 if self._law.name == ELASTIC else self._law.material.dissipation

    @property
    def owned_nodes(self) -> int:
        """Number of nodes that this rank owns."""
        return int(self.mesh.nodes.dofmap.index_map.size_local)

    @property
    def coherent(self) -> BoolArray:
        """Whether the cells are solid in the trial step, shape (cells,)."""
        return self.material.coherent

    def liquid_totals(self) -> dict[str, float] | None:
        """Return totals of feeding, pores and pressure by column; None: it never is a liquid."""
        return self.formulation.liquid_totals()

    def pores(self) -> FloatArray:
        """Return the share of the cells that is void after the last accepted step, (cells,)."""
        found = self.formulation.pores()
        return np.zeros(self.points.cells) if found is None else found

    def set_time(self, time: float) -> None:
        """Set the loads of a time [s]; collective."""
        self._evaluated_at = NOWHERE
        self.loads.set_time(time)
        self.formulation.update_load()

    def update_state(
        self,
        temperature: FloatArray,
        solid_fraction: FloatArray,
        step: float,
        between: Sequence[HeatState] = (),
    ) -> None:
        """Evaluate the law for a trial step; collective.

        Args:
            temperature: at the local nodes [°C], shape (nodes,).
            solid_fraction: likewise.
            step: time step [s].
            between: states of the nodes that the step has passed, if they are known.
        """
        self._evaluated_at, self.trials = NOWHERE, self.trials + 1
        self.material.begin(temperature, solid_fraction, step, between)
        self.formulation.begin(temperature, solid_fraction)

    def update_points(self) -> None:
        """Find stress and tangent at the present displacement and pressure.

        Raises:
            ConvergenceError: the law cannot be solved at some point; on its own rank alone.
        """
        self._evaluated_at = NOWHERE
        self.formulation.update()
        self.evaluations += 1
        self._evaluated_at = self._present().copy()

    def _present(self) -> FloatArray:
        """Return the local unknowns of nodes and mid-sides."""
        if self.midsides is None:
            return self.solution.x.array
        return np.concatenate((self.solution.x.array, self.midsides.solution.x.array))

    @property
    def is_evaluated(self) -> bool:
        """Whether stress and tangent belong to the present unknowns, on this rank."""
        return np.array_equal(self._evaluated_at, self._present())

    def _evaluate(self) -> None:
        if not self.is_evaluated:
            self.update_points()

    def residual(self) -> FloatArray:
        """Return internal minus external forces of the owned unknowns; collective.

        Raises:
            ConvergenceError: the law cannot be solved at some point; on its own rank alone.
        """
        self.update_points()
        return self.formulation.residual()

    def improve_pressures(self) -> bool:
        """Take the pressures of this rank for the multipliers; return whether there are any."""
        improved = self.formulation.improve_pressures()
        if improved:
            self._evaluated_at = NOWHERE
        return improved

    def force_scale(self) -> tuple[float, float]:
        """Return sums of squares over the owned nodes [N²], of internal forces and of the loads.

        The forces of the cells on a node count although they cancel each other.
        """
        stress = cell_stress(self.material, self.formulation.mean_stress())
        size = np.linalg.norm(stress[:, [0, 1, 2, 3, 4, 5, 3, 4, 5]], axis=1)
        G = self.points.cell_means(self.material.conditions.shear_modulus)
        size += THERMAL_SHARE * 2 * G * np.abs(self.material.contracted)
        forces = (size * self._force_of_stress)[: self.owned_cells]
        mine = _on_corners(self.mesh, forces)[: self.owned_nodes]
        load = self.formulation.forms.load
        return float(mine @ mine), float(load @ load)

    def nodal_pressure(self) -> FloatArray:
        """Return the pressure at the local nodes [Pa], shape (nodes,); collective."""
        self._evaluate()
        return self.formulation.nodal_pressure()

    def stress(self) -> FloatArray:
        """Return the stress in the cells [Pa], shape (cells, 6): xx, yy, zz, xy, xz, yz."""
        self._evaluate()
        return cell_stress(self.material, self.formulation.mean_stress())

    def mechanical_strain(self) -> FloatArray:
        """Return elastic and inelastic strain of the cells, (cells, 6) in the order of stresses."""
        self._evaluate()
        return self.material.mechanical_strain()

    def viscoplastic_strain(self) -> FloatArray:
        """Return the viscoplastic strain of the cells, (cells, 6) in the order of stresses."""
        self._evaluate()
        return self.material.viscoplastic_strain()

    def plastic_strain(self) -> FloatArray:
        """Return the equivalent viscoplastic strain of the cells, shape (cells,)."""
        self._evaluate()
        return self.points.cell_means(self.material.response.equivalent)

    def flow_of_solid(self) -> FloatArray:
        """Return ∫ (Δξ)² dV and ∫ dV over what is solid of the owned cells [m³], shape (2,).

        Δξ is the change of the equivalent viscoplastic strain in the trial step.
        """
        self._evaluate()
        material, points = self.material, self.points
        change = points.cell_means(material.response.equivalent - material.history.equivalent)
        share = points.volumes_to_cells(material.conditions.share)
        solid = (share * points.weights.sum(axis=1))[: self.owned_cells]
        return np.array([solid @ change[: self.owned_cells] ** 2, solid.sum()])

    def nodal_plastic_power(self) -> FloatArray:
        """Return the power of plastic work at the owned nodes [W], shape (owned,)."""
        power, nodes = self.material.plastic_power(), len(self.mesh.parent_vertices)
        here = self.points.shared_to_nodes(power, nodes)
        return nodal_sum(self.mesh, here)[: self.owned_nodes]

    def commit(self) -> None:
        """Accept the trial state as the start of the next step; collective."""
        self._evaluate()
        if self.formulation.commit():
            self._evaluated_at = NOWHERE

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self._evaluated_at = NOWHERE
        self.formulation.rewind()

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the parts of the body that a checkpoint keeps, by their name there."""
        return self.formulation.stateful_parts()


def point_stress(part: BodyMechanics) -> FloatArray:
    """Return the stress at the integration points of a body [Pa], shape (cells, 6 points).

    The points come one after the other, the first local direction of the cell fastest.
    """
    part.stress()  # at the present unknowns
    points, places = part.points, part.points.places.round(12)
    shape = points.cells, points.per_cell
    deviator = part.material.response.stress.reshape(*shape, points.components)
    stress = np.zeros((*shape, 6))
    stress[..., : points.components] = deviator[:, np.lexsort(places.T)]
    pressure = part.formulation.point_pressure()
    if pressure is None:
        stress[..., :3] += part.formulation.mean_stress()[:, None, None]
    else:
        stress[..., :3] += pressure.reshape(shape)[:, np.lexsort(places.T), None]
    return stress.reshape(points.cells, 6 * points.per_cell)


def _formulation(
    unknowns: BodyUnknowns,
    material: MaterialPoints,
    loads: BodyLoads,
    given: MechanicalBody,
    cells: fem.FunctionSpace,
    planes: Sequence[FixedDirections],
) -> Formulation:
    parts, law = (unknowns, material, loads), given.law
    if given.formulation == "displacement":
        return DisplacementFormulation(*parts)
    if given.mush is not None:
        return DarcyFormulation(*parts, given.mush, given.closed, given.stabilisation, planes)
    pockets = (
        NoPockets(material.points.cells)
        if law.material.liquid is None
        else Pockets(
            unknowns.mesh, unknowns.model, given.closed, loads.potential(),
            law.material.cavitation, unknowns.block_size, unknowns.midsides,
        )
    )  # fmt: skip
    if given.formulation == "taylor-hood":
        return TaylorHoodFormulation(*parts, pockets)
    if given.formulation == "q1p0":
        return Q1P0Formulation(*parts, pockets, cells, law.largest_shear_modulus())
    return MixedFormulation(*parts, pockets, given.stabilisation, planes)


def _on_corners(body: BodyMesh, forces: FloatArray) -> FloatArray:
    """Return sums at the local nodes of forces (owned cells,) on each corner of a cell."""
    corners = body.nodes.dofmap.list[: len(forces)]
    repeated = np.repeat(forces, corners.shape[1])
    here = np.bincount(corners.ravel(), repeated, len(body.parent_vertices))
    return nodal_sum(body, here)
