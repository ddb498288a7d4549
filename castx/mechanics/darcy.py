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
from dolfinx.fem.petsc import create_matrix

from castx.arrays import BoolArray, FloatArray
from castx.domain.measures import nodal_volumes
from castx.form_rows import FormRows
from castx.forms import momentum, mush, stabilisation
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import PRESSURE_SHARE, BodyUnknowns, Product, WeakForms
from castx.mechanics.loads import BodyLoads
from castx.mechanics.mixed import PressureFormulation
from castx.mechanics.mush.arms import RunningArms
from castx.mechanics.mush.content import MeltContent
from castx.mechanics.mush.feeding import FedNodes
from castx.mechanics.mush.levels import FeederLevels
from castx.mechanics.mush.metal import MushMetal
from castx.mechanics.mush.permeability import step_permeability
from castx.mechanics.mush.pores import PoreSet
from castx.mechanics.mush.sinking import SinkingLevels
from castx.mechanics.osgs import OrthogonalProjection
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
        self._tau_d = fem.Function(material.compressibility.function_space)
        self._full = fem.Function(material.compressibility.function_space)
        self._tau_e = self._full * self._tau(kind)
        self._fed = FedNodes(
            body, model, metal.feeders, closed, loads.uniform_force, loads.pressures
        )
        owned = int(body.nodes.dofmap.index_map.size_local)
        self._levels = FeederLevels(
            body.mesh.comm, body.name, self._fed.names, self._fed.areas, self._fed.feeder[:owned]
        )
        self._sinking = SinkingLevels(body.mesh.comm, self._levels)
        self.forms = self._weak_forms(loads)
        self._build_flow(loads, kind)
        self._corner = body.nodes.dofmap.list
        volumes = nodal_volumes(body, model)
        self._content = MeltContent(body, volumes, metal.contraction)
        self._pores = PoreSet(body, loads.potential(), metal.cavitation)
        self._arms = RunningArms(metal, self._corner, body.node_numbering)
        self._projections = []
        if kind == "osgs":
            excess = mush.excess(self._tau_e, self._tau_d)
            self._projections.append(OrthogonalProjection(unknowns, excess, planes))
        self._least = volumes * PRESSURE_SHARE / (unknowns.pressure_scale * unknowns.length)
        self._holding = self._least
        self._rows = slice(unknowns.pressure_component, None, unknowns.block_size)
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

    def _build_flow(self, loads: BodyLoads, kind: str) -> None:
        """Compile flow and stabilisation of the continuity rows, and their matrix."""
        (_, q), (_, change), dx = self._test(), self._trial(), self._dx_p
        excess, force = mush.excess(self._tau_e, self._tau_d), loads.body_force
        if kind == "gls":
            stabilised = mush.darcy_flow(self._p, q, force, excess, dx)
        else:
            stabilised = stabilisation.pressure_laplacian(self._p, q, excess, dx)
        # Apart from the loads, since its facets have tags of their own.
        test = self._unknowns.displacement(ufl.TestFunction(self._unknowns.space))
        self._head = fem.form(self._fed.virtual_work(test))
        both = self._tau_d + excess
        self._flow = fem.form(mush.darcy_flow(self._p, q, force, self._tau_d, dx))
        self._stabilised = fem.form(stabilised)
        matrix = fem.form(stabilisation.pressure_laplacian(change, q, both, dx))
        self._flow_rows, self._flow_matrix = FormRows(matrix), create_matrix(matrix)

    def begin(self, temperature: FloatArray, solid_fraction: FloatArray) -> None:
        """Find permeability, fed nodes and first pores of a trial step; collective."""
        material, content = self._material, self._content
        c, before = material.conditions, material.start_volume
        born = (c.share - c.start_share) * c.solid_compressibility * before.mean_stress
        material.thermal_strain.x.array[:] = content.begin(solid_fraction, c.contraction - born)
        start = 1.0 - content.start.solid
        permeability = step_permeability(
            self._resistance, start[self._corner], (1.0 - solid_fraction)[self._corner]
        )
        spacing = self._arms.begin(temperature, material.step_size)
        empty = content.emptied[self._corner].any(axis=1)
        flows = permeability * spacing**2 * material.step_size / self._metal.viscosity
        self._tau_d.x.array[:] = flows = np.where(empty, 0.0, flows)
        self._full.x.array[:] = ~empty
        self._fed.begin(start, self._resistance.cut_off)
        freezes = solid_fraction > content.start.solid
        self._pores.begin(start, freezes, flows > 0.0, self._fed.nodes, empty)
        comm = self._unknowns.mesh.mesh.comm
        self._mushy = bool(comm.allreduce(bool((start > 0.0).any()), op=MPI.LOR))
        self._assemble_flow()
        self._sinking.begin([self._of_metre(k) for k in range(len(self._levels.drops))])

    def _of_metre(self, number: int) -> FloatArray:
        """Return the change of the residual for a fall of a feeder by a metre, (unknowns,)."""
        head = self._fed.of_metre(number)
        self._fed.use(head)
        change = -self.forms.assemble(self._head)
        given = self._unknowns.pressure_scale * self._holding * -head[: self._content.owned]
        change[self._rows] += given
        return change

    def _assemble_flow(self) -> None:
        self._flow_rows.assemble(self._flow_matrix)
        # Rows of given pressures count like the flow to their nodes, or the volume of a level.
        diagonal = self._flow_matrix.getDiagonal()
        flow = diagonal.array_r[self._rows] / self._unknowns.pressure_scale**2
        self._holding = self._least + np.minimum(flow, self._fed.volumes[: len(flow)])
        diagonal.destroy()
        for projection in self._projections:
            projection.assemble()

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
        """Return what feeders give to the owned nodes [m³ of liquid], shape (owned,)."""
        return np.where(self._fed_nodes, self._content.weight * missing, 0.0)

    def _volumes(self, form: fem.Form) -> FloatArray:
        """Return the rows of pressures of a linear form as volumes [m³], shape (owned,)."""
        rows = self.forms.assemble(form)[self._rows]
        return np.asarray(rows / self._unknowns.pressure_scale, dtype=np.float64)

    def _missing(self, stretched: FloatArray) -> FloatArray:
        """Return the volumes that nothing fills [m³], shape (owned,), see `MeltContent.missing`."""
        flow = self._volumes(self._flow) + self._volumes(self._stabilised)
        projected = np.zeros(self._unknowns.owned)
        for projection in self._projections:
            projection.add_product(self._unknowns.solution.x.array, projected)
        flow -= projected[self._rows] / self._unknowns.pressure_scale
        return self._content.missing(stretched, flow)

    def _balance(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return forces of all rows, stretched and missing volumes [m³]; collective."""
        b = self.forms.residual()
        stretched = np.asarray(b[self._rows] / self._unknowns.pressure_scale, dtype=np.float64)
        return b, stretched, self._missing(stretched)

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
        shares = A.createVecLeft()
        shares.array[:] = 0.0
        shares.array[self._rows] = -1.0 / self._content.weight
        flow = self._flow_matrix.copy()
        flow.diagonalScale(shares, None)
        A.axpy(1.0, flow, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        flow.destroy()
        held = self._held()
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
        found, (chosen, image) = [], (A.createVecLeft(), A.createVecRight())
        feeder = self._fed.feeder[: self._content.owned]
        for number in range(len(self._levels.drops)):
            own = self._fed_nodes & (feeder == number)
            chosen.array[:] = 0.0
            chosen.array[self._rows] = own / self._unknowns.pressure_scale
            weighed, rest = chosen.array_r.copy(), np.zeros(self._unknowns.owned)
            chosen.array[self._rows] *= self._content.weight
            A.multTranspose(chosen, image)
            for projection in self._projections:
                projection.add_product(weighed, rest)
            found.append(image.array_r + rest)
        chosen.destroy()
        image.destroy()
        return found

    def coupled_products(self) -> list[Product]:
        """Return what the fall of the feeders adds, by which supplies tie all unknowns."""
        return [self._sinking.add_product]

    def products(self) -> list[Product]:
        """Return the part of OSGS beyond GLS, Σ_e τ_x ∫ ∇q·Π(p)/(1 + β f_i)."""
        return [self._product] if self._projections else []

    def _product(self, x: FloatArray, y: FloatArray) -> None:
        projected = np.zeros(self._unknowns.owned)
        for projection in self._projections:
            projection.add_product(x, projected)
        y[self._rows] += np.where(self._held(), 0.0, projected[self._rows] / self._content.weight)

    def improve_pressures(self) -> bool:
        """Open and close pores at the present unknowns; return whether any has changed here."""
        _, _, missing = self._balance()
        return self._pores.change(missing, self._content.volumes, self._stress())

    def mean_stress(self) -> FloatArray:
        """Return the means of the nodal pressures of the cells [Pa], shape (cells,)."""
        return np.asarray(self.nodal_pressure()[self._corner].mean(axis=1))

    @property
    def has_pockets(self) -> bool:
        """Whether there is melt in the trial step, whose pores may open and close."""
        return self._mushy

    def liquid_totals(self) -> dict[str, float] | None:
        """Return the volumes of the ledger, pores, and the mean pressure of what is left melt."""
        ledger = self._content.ledger
        return {
            "feeding_demand": ledger.demand,
            "fed_volume": ledger.fed,
            "opened_volume": ledger.opened,
            "yielded_volume": ledger.yielded,
            "unfed_volume": self._content.porosity(),
            "pocket_pressure": self._mean_pressure(),
            **self._levels.totals(),
        }

    def _mean_pressure(self) -> float:
        content = self._content
        melt = content.volumes * (1.0 - content.start.solid[: content.owned])
        sums = np.array([float(melt @ self._stress()), float(melt.sum())])
        total, volume = self._unknowns.mesh.mesh.comm.allreduce(sums, op=MPI.SUM)
        return float(total / volume) if volume > 0.0 else 0.0

    def commit(self) -> bool:
        """Accept the trial state as the start of the next step; collective.

        Returns:
            False: the residual stays.
        """
        content, (_, stretched, missing) = self._content, self._balance()
        supply = self._supply(missing)
        pores = np.where(self._pores.open, missing / content.volumes, content.frozen_pores)
        self._material.commit(self.mean_stress())
        content.commit(stretched, self._volumes(self._flow), supply, pores, self._stress())
        self._levels.commit(supply)
        self._pores.commit()
        self._arms.commit()
        return False

    def rewind(self) -> None:
        """Return to the last accepted step, whose displacement the caller sets."""
        self._material.rewind()
        for part in (self._content, self._pores, self._arms):
            part.rewind()
        self._assemble_flow()

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the histories of the integration points and of the melt."""
        return {
            "points": self._material, "melt": self._content, "pores": self._pores,
            "arms": self._arms, "levels": self._levels,
        }  # fmt: skip

