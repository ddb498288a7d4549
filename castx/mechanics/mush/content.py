"""Melt that a body holds: content of its nodes, and the ledger of what freezing has asked for.

With the volume X = 1 + ∇·u − φ − e − p/K of a node over its reference volume V, φ its pores, e the
volumetric strain of its solid without pressure and f its solid fraction, the content

    M = (1 + β f) X V,

in volumes of liquid, changes by nothing but flow:  M ← M + Σ_e τ_D ∫ ∇q·(∇p + b) + supply. So solid
that is born has its volume in M. What is kept is S = M − (1 + β f) V, so that strains do not drown
in the rounding of volumes. Over a step and a body

    demand Σ V β Δf X_n = supplied + Σ (1 + β f) Δφ V − Σ (1 + β f) Δ(∇·u − e − p/K) V.
"""

from __future__ import annotations

from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.stateful import Arrays, Saved, number


class MeltNodes(NamedTuple):
    """State of the nodes after an accepted step, each of shape (nodes,).

    Attributes:
        solid: f.
        surplus: S [m³].
        pores: φ.
        stretched: (∇·u − e − p/K) V [m³].
        stress: p [Pa].
    """

    solid: FloatArray
    surplus: FloatArray
    pores: FloatArray
    stretched: FloatArray
    stress: FloatArray


class MeltLedger(NamedTuple):
    """Volumes of liquid since the start of a run [m³].

    Attributes:
        demand: what freezing has asked for.
        fed: what feeders have supplied.
        opened: what pores have made up for.
        yielded: what skeleton and walls have given way.
    """

    demand: float = 0.0
    fed: float = 0.0
    opened: float = 0.0
    yielded: float = 0.0


class MeltContent:
    """Content of the nodes of one body.

    Args:
        body: mesh of the body.
        volumes: of its owned nodes [m³], shape (owned,).
        contraction: β.

    Attributes:
        volumes: of the owned nodes [m³], shape (owned,).
        start: the nodes at the start of the step.
        solid: f of the local nodes at its end, shape (nodes,).
        strain: e of the cells at the start of the step, shape (cells,).
        ledger: up to the start of the step.
    """

    def __init__(self, body: BodyMesh, volumes: FloatArray, contraction: float) -> None:
        self._body, self.volumes, self.contraction = body, volumes, contraction
        none: FloatArray = np.zeros(len(body.parent_vertices))
        self.start, self._started = MeltNodes(*[none] * 5), False
        self.solid: FloatArray = none
        self.strain: FloatArray = np.zeros(len(body.nodes.dofmap.list))
        self._trial_strain: FloatArray = self.strain
        self.ledger = MeltLedger()

    def begin(self, solid: FloatArray, gained: FloatArray) -> FloatArray:
        """Begin a trial step; return e of the cells at its end, shape (cells,).

        What the first call finds is the state at the start, full of melt.

        Args:
            solid: f of the local nodes at the end of the step, shape (nodes,).
            gained: change of e in the step, shape (cells,).
        """
        if not self._started:
            self.start = self.start._replace(solid=solid.copy())
            self._started = True
        self.solid = solid.copy()
        self._trial_strain = self.strain + gained
        return self._trial_strain

    @property
    def owned(self) -> int:
        """Number of owned nodes."""
        return len(self.volumes)

    @property
    def weight(self) -> FloatArray:
        """1 + β f of the owned nodes at the end of the step, shape (owned,)."""
        return np.asarray(1.0 + self.contraction * self.solid[: self.owned])

    @property
    def emptied(self) -> BoolArray:
        """Whether local nodes have lost all their melt at the start of the step, (nodes,)."""
        liquid = 1.0 - self.start.solid
        return np.asarray((liquid > 0.0) & (self.start.pores >= liquid))

    @property
    def frozen_pores(self) -> FloatArray:
        """φ of owned nodes that are solid from the start on, else zero, shape (owned,)."""
        start, own = self.start, slice(self.owned)
        return np.where(start.solid[own] >= 1.0, start.pores[own], 0.0)

    def missing(self, stretched: FloatArray, flow: FloatArray) -> FloatArray:
        """Return the volumes that nothing fills at the owned nodes [m³], shape (owned,).

        These are pores, or what a feeder has to supply.

        Args:
            stretched: (∇·u − e − p/K) V [m³], shape (owned,).
            flow: what has flown to the nodes [m³ of liquid], stabilisation included, (owned,).
        """
        lacking = self._asked() - self.start.surplus[: self.owned] - flow
        return np.asarray(stretched - self.volumes * self.frozen_pores + lacking / self.weight)

    def _asked(self) -> FloatArray:
        """Return β Δf V of the owned nodes in the trial step [m³], shape (owned,)."""
        frozen = (self.solid - self.start.solid)[: self.owned]
        return np.asarray(self.contraction * frozen * self.volumes)

    def commit(
        self,
        stretched: FloatArray,
        flow: FloatArray,
        supply: FloatArray,
        pores: FloatArray,
        stress: FloatArray,
        born: FloatArray | float = 0.0,
    ) -> None:
        """Accept the trial step; collective.

        Args:
            stretched: (∇·u − e − p/K) V at its end [m³], shape (owned,).
            flow: what Darcy's law has brought to the nodes [m³], shape (owned,).
            supply: what feeders have, likewise.
            pores: φ, likewise.
            stress: p [Pa], likewise.
            born: change of e by solid that the strain of the step has not met, shape (cells,).
        """
        own, start, weight = slice(self.owned), self.start, self.weight
        volume = self.volumes * (1.0 - start.pores[own]) + start.stretched[own]
        demand = self.contraction * (self.solid - start.solid)[own] @ volume
        opened = weight @ (self.volumes * (pores - start.pores[own]))
        yielded = -weight @ (stretched - start.stretched[own])
        sums = np.array([demand, supply.sum(), opened, yielded])
        sums = self._body.mesh.comm.allreduce(sums, op=MPI.SUM)
        self.ledger = MeltLedger(*(np.array(self.ledger) + sums).tolist())
        surplus = start.surplus[own] + flow + supply - self._asked()
        found = (surplus, pores, stretched, stress)
        self.start = MeltNodes(self.solid, *(self._with_ghosts(values) for values in found))
        self.strain = self._trial_strain + born

    def _with_ghosts(self, owned: FloatArray) -> FloatArray:
        values = np.zeros(len(self.solid))
        values[: self.owned] = owned
        return nodal_sum(self._body, values)

    def porosity(self) -> float:
        """Return the volume of all pores after the last accepted step [m³]; collective."""
        here = float(self.start.pores[: self.owned] @ self.volumes)
        return float(self._body.mesh.comm.allreduce(here, op=MPI.SUM))

    def mean_pressure(self, stress: FloatArray) -> float:
        """Return the mean over the melt of values of the owned nodes; 0 without any; collective.

        Args:
            stress: p [Pa], shape (owned,).
        """
        melt = self.volumes * (1.0 - self.start.solid[: self.owned])
        sums = np.array([float(melt @ stress), float(melt.sum())])
        total, volume = self._body.mesh.comm.allreduce(sums, op=MPI.SUM)
        return float(total / volume) if volume > 0.0 else 0.0

    def largest_suction(self, stress: FloatArray) -> float:
        """Return the largest positive p of nodes with melt, 0 without any; collective.

        Args:
            stress: p [Pa], shape (owned,).
        """
        melt = self.start.solid[: self.owned] < 1.0
        here = float(stress[melt].max(initial=0.0))
        return float(self._body.mesh.comm.allreduce(here, op=MPI.MAX))

    def totals(self, stress: FloatArray) -> dict[str, float]:
        """Return the ledger, the pores and what p is in the melt, by their columns; collective.

        Args:
            stress: p of the owned nodes [Pa], shape (owned,).
        """
        ledger = self.ledger
        return {
            "feeding_demand": ledger.demand,
            "fed_volume": ledger.fed,
            "opened_volume": ledger.opened,
            "yielded_volume": ledger.yielded,
            "unfed_volume": self.porosity(),
            "pocket_pressure": self.mean_pressure(stress),
            "melt_suction": self.largest_suction(stress),
        }

    def rewind(self) -> None:
        """Return to the start of the step."""
        self.solid, self._trial_strain = self.start.solid, self.strain

    def saved(self) -> dict[str, Saved]:
        """Return nodes, strain and ledger."""
        nodes, bodies = self._body.node_numbering, (self._body.name,)
        found = {name: Saved(v, nodes) for name, v in self.start._asdict().items()}
        found["strain"] = Saved(self.strain, self._body.cell_numbering)
        return found | {n: number(v, bodies=bodies) for n, v in self.ledger._asdict().items()}

    def restore(self, arrays: Arrays) -> None:
        """Take them back."""
        self.start = MeltNodes(*(arrays[name].copy() for name in MeltNodes._fields))
        self.strain, self._started = arrays["strain"].copy(), True
        self.ledger = MeltLedger(*(float(arrays[name]) for name in MeltLedger._fields))
        self.rewind()
