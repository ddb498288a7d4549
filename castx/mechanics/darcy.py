"""Mixed formulation of a body through whose mush melt flows: pressure, feeding and pores at once.

For all η and q, with β the contraction of freezing, f the solid fraction, φ pores and M the content
of the nodes (`castx.mechanics.mush.content`),

    ∫ ∇ˢη:s + ∫ p ∇·η = ∫ η·b + ∫_Γ η·t̄,
    (1 + β f_i) [∫ q (1 + ∇·u - p/K - e^θ) - φ_i V_i] - M_i - flow_i = 0,
    flow_i = Σ_e τ_D ∫ ∇q·(∇p + b) + Σ_e τ_x ∫ ∇q·(∇p - Π),

where q is the shape function of a node i. Its row is divided by 1 + β f_i, so that ∇·u is the
transpose of p in the momentum. p is the mean stress of the melt wherever some is left; solid cells
have τ_D = 0, τ_x = τ_e, and the law of the solid with the volume of its birth in M. Cells at a node
without melt, whose pores have reached 1 - f, let nothing through.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.domain.measures import cell_means, nodal_volumes
from castx.forms import momentum
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import PRESSURE_SHARE, BodyUnknowns, Product, WeakForms
from castx.mechanics.loads import BodyLoads
from castx.mechanics.melt_flow import MeltFlow
from castx.mechanics.mixed import PressureFormulation
from castx.mechanics.mush.arms import RunningArms
from castx.mechanics.mush.content import MeltContent
from castx.mechanics.mush.feeding import FedNodes
from castx.mechanics.mush.levels import FeederLevels
from castx.mechanics.mush.metal import MushMetal
from castx.mechanics.mush.permeability import step_permeability
from castx.mechanics.mush.pores import PoreSet
from castx.mechanics.mush.sinking import SinkingLevels
from castx.mechanics.mush.wall import WallMelt
from castx.stateful import Stateful


class DarcyFormulation(PressureFormulation):
    """Momentum balance of one body and the flow of its melt.

    Args:
        unknowns: of the body, with the pressure.
        material: stress and tangent at its integration points, without strain of solidification.
        loads: on the body.
        metal: its melt.
        closed: names of the surfaces that are not free.
        kind: stabilisation, "osgs" or "gls".
        planes: symmetry planes, behind which the body goes on as its mirror image.
    """

    def __init__(
        self,
        unknowns: BodyUnknowns,
        material: MaterialPoints,
        loads: BodyLoads,
        metal: MushMetal,
        closed: Collection[str],
        kind: str,
        planes: Sequence[FixedDirections],
    ) -> None:
        super().__init__(unknowns, material)
        body, model = unknowns.mesh, unknowns.model
        self._metal, self._resistance, self._loads = metal, metal.resistance(), loads
        self._fed = FedNodes(
            body, model, metal.feeders, closed, loads.uniform_force, loads.pressures
        )
        owned = int(body.nodes.dofmap.index_map.size_local)
        self._levels = FeederLevels(
            body.mesh.comm, body.name, self._fed.names, self._fed.areas, self._fed.feeder[:owned]
        )
        self._sinking = SinkingLevels(body.mesh.comm, self._levels)
        self.forms = self._weak_forms(loads)
        # Apart from the loads, since its facets have tags of their own.
        eta = unknowns.displacement(ufl.TestFunction(unknowns.space))
        self._head = fem.form(self._fed.virtual_work(eta))
        cells = material.compressibility.function_space
        self._flow = MeltFlow(
            unknowns, cells, self._tau(kind), loads.body_force, kind, planes, self._dx_p
        )
        self._rows = self._flow.rows
        self._corner = body.nodes.dofmap.list
        volumes = nodal_volumes(body, model)
        self._content = MeltContent(body, volumes, metal.contraction)
        self._pores = PoreSet(body, loads.potential(), metal.cavitation)
        self.wall_melt = WallMelt(self._content, self._pores, metal)
        self._arms = RunningArms(metal, self._corner, body.node_numbering)
        self._least = volumes * PRESSURE_SHARE / (unknowns.pressure_scale * unknowns.length)
        self._holding = self._least
        self._mushy = False

    def _weak_forms(self, loads: BodyLoads) -> WeakForms:
        """Return momentum and ∫ q (∇·u - p/K - e^θ)."""
        unknowns, state = self._unknowns, self._material.state()
        variation, q = self._test()
        increment, change = self._trial()
        eta = unknowns.displacement(ufl.TestFunction(unknowns.space))
        measures = self._dx, self._dx_p
        return WeakForms(
            unknowns,
            momentum.mixed_internal_virtual_work(
                self._total, self._p, variation, q, state, *measures
            ),
            momentum.mixed_tangent(increment, change, variation, q, state, *measures),
            loads.virtual_work(eta),
            loads.backing,
            unknowns.held(self._material.thickness, self._dx),
        )

    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Find permeability, fed nodes and first pores of a trial step; collective."""
        material, content = self._material, self._content
        c, before = material.conditions, material.start_volume
        born = (c.strained_share - c.start_share) * c.solid_compressibility * before.mean_stress
        material.thermal_strain.x.array[:] = content.begin(solid_fraction, c.contraction - born)
        start = 1.0 - content.start.solid
        permeability = step_permeability(
            self._resistance, start[self._corner], (1.0 - solid_fraction)[self._corner]
        )
        spacing = self._arms.begin(temperature, solid_fraction, material.step_size)
        empty = content.emptied[self._corner].any(axis=1)
        flows = permeability * spacing**2 * material.step_size / self._metal.viscosity
        tau_d: FloatArray = np.asarray(np.where(empty, 0.0, flows), dtype=np.float64)
        self._flow.begin(tau_d, np.where(empty, 0.0, 1.0))
        self._fed.begin(start, self._resistance.cut_off)
        freezes = solid_fraction > content.start.solid
        melts = (start <= 0.0) & (solid_fraction < 1.0)
        self._pores.begin(start, freezes, melts, tau_d > 0.0, self._fed.nodes, empty)
        comm = self._unknowns.mesh.mesh.comm
        self._mushy = bool(comm.allreduce(bool((start > 0.0).any()), op=MPI.LOR))
        # Rows of given pressures count like the flow to their nodes, or the volume of a level.
        volumes = self._fed.volumes[: content.owned]
        self._holding = self._least + np.minimum(self._flow.conductance, volumes)
        self._sinking.begin([self._of_metre(k) for k in range(len(self._levels.drops))])

    def _of_metre(self, number: int) -> FloatArray:
        """Return the change of the residual for a fall of a feeder by a metre, (unknowns,)."""
        head = self._fed.of_metre(number)
        self._fed.use(head)
        change = -self.forms.assemble(self._head)
        given = self._unknowns.pressure_scale * self._holding * -head[: self._content.owned]
        change[self._rows] += given
        return change

    @property
    def _fed_nodes(self) -> BoolArray:
        return self._fed.nodes[: self._content.owned]

    def _held(self) -> BoolArray:
        """Return whether the pressure of the owned nodes is given, shape (owned,)."""
        return self._fed_nodes | self._pores.open | self._pores.resting

    def _given(self, drops: FloatArray) -> FloatArray:
        """Return given pressures of the owned nodes [Pa], shape (owned,).

        Args:
            drops: by which levels have sunk [m], shape (feeders,).
        """
        own = slice(self._content.owned)
        given = np.where(self._fed_nodes, self._fed.mean_stress(drops)[own], self._metal.cavitation)
        return np.where(self._pores.resting, self._content.start.stress[own], given)

    def _supply(self, missing: FloatArray) -> FloatArray:
        """Return the supply of the owned nodes by feeders [m³ of liquid], shape (owned,)."""
        return np.where(self._fed_nodes, self._content.weight * missing, 0.0)

    def _balance(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return forces of all rows, stretched and missing volumes [m³]; collective."""
        b = self.forms.residual()
        stretched = np.asarray(b[self._rows] / self._unknowns.pressure_scale, dtype=np.float64)
        return b, stretched, self._content.missing(stretched, self._flow.arriving(self.forms))

    def _stress(self) -> FloatArray:
        """Return p at the owned nodes [Pa], shape (owned,)."""
        return self.nodal_pressure()[: self._content.owned]

    def residual(self) -> FloatArray:
        """Return internal minus external forces for the stresses of `update`; collective."""
        b, _, missing = self._balance()
        drops = self._levels.drops + self._levels.falls(self._supply(missing))
        self._fed.use(self._fed.head(drops))
        b -= self.forms.assemble(self._head)
        away = self._holding * (self._given(drops) - self._stress())
        b[self._rows] = self._unknowns.pressure_scale * np.where(self._held(), away, missing)
        return b

    def assemble_jacobian(self, A: PETSc.Mat) -> None:
        """Assemble the Jacobian; for OSGS the one of GLS, as a preconditioner."""
        self.forms.assemble_jacobian(A)
        self._flow.add_to(A, self._content.weight)
        held, shares = self._held(), A.createVecLeft()
        self._sinking.update(self._supplies(A))
        shares.array[:] = 1.0
        shares.array[self._rows] = np.where(held, 0.0, 1.0)
        A.diagonalScale(shares, None)
        A.getDiagonal(shares)
        diagonal = -(self._unknowns.pressure_scale**2) * self._holding
        values = shares.array
        values[self._rows] = np.where(held, diagonal, values[self._rows])
        A.setDiagonal(shares)
        A.assemble()
        shares.destroy()

    def _supplies(self, A: PETSc.Mat) -> list[FloatArray]:
        """Return the derivatives of what the feeders supply, each of shape (owned unknowns,).

        Args:
            A: Jacobian with the rows of all pressures as volumes.
        """
        if not self._sinking.sinks:
            return []
        feeder, weight = self._fed.feeder[: self._content.owned], self._content.weight
        chosen = [self._fed_nodes & (feeder == k) for k in range(len(self._levels.drops))]
        return [self._flow.supply(A, nodes, weight) for nodes in chosen]

    def coupled_products(self) -> list[Product]:
        """Return the products of the sinking levels, by which supplies tie all unknowns."""
        return [self._sinking.add_product]

    def products(self) -> list[Product]:
        """Return the part of OSGS beyond GLS, Σ_e τ_x ∫ ∇q·Π(p)/(1 + β f_i)."""
        return [self._product]

    def _product(self, x: FloatArray, y: FloatArray) -> None:
        projected = self._flow.projected(x)
        y[self._rows] += np.where(self._held(), 0.0, projected[self._rows] / self._content.weight)

    def improve_pressures(self) -> bool:
        """Open and close pores at the present unknowns; return whether any has changed here."""
        _, _, missing = self._balance()
        return self._pores.change(missing, self._content.volumes, self._stress())

    @property
    def pores_changed(self) -> bool:
        """Whether pores on this rank have opened or closed at the iterate of the last call."""
        return self._pores.changed

    def mean_stress(self) -> FloatArray:
        """Return the means of the nodal pressures of the cells [Pa], shape (cells,)."""
        return np.asarray(self.nodal_pressure()[self._corner].mean(axis=1))

    @property
    def has_pockets(self) -> bool:
        """Whether there is melt in the trial step, whose pores may open and close."""
        return self._mushy

    def liquid_totals(self) -> dict[str, float] | None:
        """Return the volumes of the ledger, pores, and the mean pressure of what is left melt."""
        return self._content.totals(self._stress()) | self._levels.totals()

    def pores(self) -> FloatArray:
        """Return means of the pores over the cells, as shares, shape (cells,)."""
        return cell_means(self._unknowns.mesh, self._unknowns.model, self._content.start.pores)

    def commit(self) -> bool:
        """Accept the trial state as the start of the next step; collective.

        Returns:
            False: the residual stays.
        """
        content, (_, stretched, missing) = self._content, self._balance()
        fed = self._supply(missing)
        opened = np.where(self._pores.open, missing / content.volumes, 0.0)
        pores = content.frozen_pores + opened
        mean_stress = self.mean_stress()
        born = self._material.conditions.born_later(mean_stress)
        self._material.commit(mean_stress)
        content.commit(stretched, self._flow.drained(self.forms), fed, pores, self._stress(), born)
        self._levels.commit(fed)
        self._pores.commit()
        self._arms.commit()
        return False

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self._material.rewind()
        for part in (self._content, self._pores, self._arms):
            part.rewind()
        self._flow.assemble()

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the histories of the integration points and of the melt."""
        return {
            "points": self._material, "melt": self._content, "pores": self._pores,
            "arms": self._arms, "levels": self._levels,
        }  # fmt: skip
