"""Metal in the cells of a body: the feeding demand of freezing, fed volume, pores.

Metal that freezes shrinks. Below coherency (the solid fraction f_c) liquid makes up for it, by the
feeding demand of a cell of volume V in a step,

    D = V s Δmin(f_s, f_c),   s = (ρ_solid − ρ_liquid)/ρ_solid.

A cell in reach of a free surface is fed. In a pocket the content e of the cells, the volumetric
strain at which they would be full, sinks by the demand instead, also by that of cells that freeze
at its wall; what the volumetric strain θ exceeds it by is the void of the pocket,

    Σ V (θ − e) ≥ 0,

spread evenly over its liquid. What a cell holds of it when it freezes stays as porosity. Volumes
are those of solid metal, and for each body demand = fed + growth of the voids + what the walls of
the pockets gave way.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.stateful import Array, Arrays, Numbering, Saved, number


class Content:
    """Content and pores of the cells of one body, and its balance of feeding.

    Args:
        comm: the ranks.
        numbering: of the cells.
        volumes: of the owned cells [m³], shape (owned,).

    Attributes:
        pocket: number of the pocket of each cell in the trial step, −1: none, shape (cells,).
        pockets: volumes of the liquid of the pockets [m³], equal on all ranks, shape (pockets,).
        demand: feeding demand so far [m³].
        fed: what has been fed so far [m³].
        void: present volume of all pores [m³].
    """

    def __init__(self, comm: MPI.Intracomm, numbering: Numbering, volumes: FloatArray) -> None:
        self._comm, self._numbering, self._volumes = comm, numbering, volumes
        self.demand = self.fed = self.void = 0.0
        self._started = False
        cells = len(numbering.numbers)
        self.pocket: IntArray = np.full(cells, -1, dtype=np.int32)
        self.pockets: FloatArray = np.zeros(0)
        none: FloatArray = np.zeros(cells)
        self._full, self._pores, self._shrunk = none, none, none
        self._trial_full, self._trial_pores, self._trial_shrunk = none, none, none
        self._last_pocket: IntArray = self.pocket
        self._last_count = 0
        self._liquid: BoolArray = np.zeros(cells, dtype=bool)

    def begin(
        self, pocket: IntArray, liquid: BoolArray, shrunk: FloatArray, skeleton: FloatArray
    ) -> None:
        """Find the content of the cells in a trial step; collective.

        The first state of all is full everywhere, whatever has frozen there.

        Args:
            pocket: number of the pocket of each cell, −1: none, shape (cells,).
            liquid: whether a cell is a liquid, shape (cells,).
            shrunk: s min(f_s, f_c) of the cells, shape (cells,).
            skeleton: strain of the skeleton beyond coherency since the body was free of strain,
                shape (cells,).
        """
        count = 1 + self._comm.allreduce(int(pocket.max(initial=-1)), op=MPI.MAX)
        if not self._started:
            self._started = True
            self._shrunk, self._last_pocket, self._last_count = shrunk, pocket, count
            self._full = np.where(liquid, 0.0, -skeleton)
        self.pocket, self._liquid, self._trial_shrunk = pocket, liquid, shrunk
        self.pockets = self._sums(pocket, count, np.ones(len(pocket)))
        self._fill(shrunk - self._shrunk)

    def _fill(self, change: FloatArray) -> None:
        trapped, last = self.pocket >= 0, self._last_pocket
        inside = last >= 0
        # What freezes at the wall of a pocket draws from the liquid that is left there.
        lost = self._sums(np.where(self._liquid, -1, last), self._last_count, change)
        room = self._sums(np.where(trapped, last, -1), self._last_count, np.ones(len(last)))
        share = np.divide(lost, room, out=np.zeros_like(lost), where=room > 0)
        drawn, alone = np.zeros(len(last)), np.zeros(len(last), dtype=bool)
        drawn[inside], alone[inside] = share[last[inside]], room[last[inside]] == 0
        full, pores = self._full + np.where(self._liquid, self._pores, 0.0), self._pores
        self._trial_full = np.where(trapped, self._full - change - drawn, full)
        self._trial_pores = np.where(self._liquid, 0.0, pores)
        final = alone & ~self._liquid  # nothing is left from which it could draw
        self._trial_full[final] -= change[final]
        self._trial_pores[final] = np.maximum(pores + change, 0.0)[final]

    def _sums(self, group: IntArray, count: int, values: FloatArray) -> FloatArray:
        """Return the sums of V times values over the cells of each group, shape (count,)."""
        owned = group[: len(self._volumes)]
        mine = owned >= 0
        weights = (self._volumes * values[: len(owned)])[mine]
        sums = np.bincount(owned[mine], weights, count).astype(np.float64)
        return np.asarray(self._comm.allreduce(sums, op=MPI.SUM))

    @property
    def was_trapped(self) -> BoolArray:
        """Whether the cells were trapped at the start of the step, shape (cells,)."""
        return self._last_pocket >= 0

    @property
    def free_volume(self) -> FloatArray:
        """Volumetric strain at which the cells are full, with frozen pores, shape (cells,)."""
        return self._trial_full + self._trial_pores

    def mean(self, values: FloatArray) -> FloatArray:
        """Return the means of values of the cells in each pocket, shape (pockets,); collective."""
        return self._sums(self.pocket, len(self.pockets), values) / self.pockets

    def largest(self, values: FloatArray | IntArray) -> FloatArray:
        """Return the largest value of the cells in each pocket, shape (pockets,); collective."""
        found = np.full(len(self.pockets), -np.inf)
        inside = self.pocket >= 0
        np.maximum.at(found, self.pocket[inside], values[inside])
        self._comm.Allreduce(MPI.IN_PLACE, found, op=MPI.MAX)
        return found

    def void_fraction(self, dilatation: FloatArray) -> FloatArray:
        """Return the void of each pocket over its volume, shape (pockets,); collective.

        Args:
            dilatation: volumetric strain θ of the cells, shape (cells,).
        """
        return self.mean(dilatation - self._trial_full)

    def commit(self, dilatation: FloatArray, porous: BoolArray) -> None:
        """Book an accepted step; collective.

        Liquid flows to where a pocket has room: its cells are full at the volumes that they have,
        but for the void, or for the compression, of the whole pocket.

        Args:
            dilatation: volumetric strain of the cells, shape (cells,).
            porous: whether each pocket has pores, shape (pockets,).
        """
        change, trapped = self._trial_shrunk - self._shrunk, self.pocket >= 0
        fed = np.where(self._liquid, change + self._pores, change)
        fed = np.where(trapped | (~self._liquid & (self._last_pocket >= 0)), 0.0, fed)
        fraction = self.void_fraction(dilatation)
        cells = trapped.copy()
        cells[trapped] = porous[self.pocket[trapped]]
        self._full, self._pores = self._trial_full.copy(), self._trial_pores.copy()
        self._pores[cells] = fraction[self.pocket[cells]]
        self._full[trapped] = dilatation[trapped] - fraction[self.pocket[trapped]]
        self._shrunk, self._last_pocket = self._trial_shrunk, self.pocket
        self._last_count = len(self.pockets)
        demand, fed_now, self.void = self._totals(change, fed, self._pores)
        self.demand, self.fed = self.demand + demand, self.fed + fed_now

    def _totals(self, *values: FloatArray) -> FloatArray:
        owned = len(self._volumes)
        mine = np.array([self._volumes @ each[:owned] for each in values])
        totals: FloatArray = self._comm.allreduce(mine, op=MPI.SUM)
        return totals

    def saved(self) -> dict[str, Saved]:
        """Return the committed state and the booked volumes."""
        cells: dict[str, Array] = {
            "content": self._full, "pores": self._pores,
            "shrunk": self._shrunk, "pocket": self._last_pocket,
        }  # fmt: skip
        booked = {"demand": self.demand, "fed": self.fed, "pockets": float(self._last_count)}
        return {name: Saved(values, self._numbering) for name, values in cells.items()} | {
            name: number(value, bodies=self._numbering.bodies) for name, value in booked.items()
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore a committed state; collective."""
        self._started = True
        self._full, self._pores = arrays["content"].copy(), arrays["pores"].copy()
        self._shrunk = arrays["shrunk"].copy()
        self._last_pocket = np.asarray(arrays["pocket"], dtype=np.int32)
        self._last_count = int(arrays["pockets"])
        self.demand, self.fed = float(arrays["demand"]), float(arrays["fed"])
        (self.void,) = self._totals(self._pores)
