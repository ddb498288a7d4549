"""Metal in the cells of a body: the feeding demand of freezing, fed volume, pores.

Metal that freezes shrinks. Up to the solid fraction f_c liquid makes up for it, by the feeding
demand of a cell of volume V in a step,

    D = V s Δmin(f_s, f_c),   s = (ρ_solid − ρ_liquid)/ρ_solid.

A cell in reach of a free surface is fed, up to the moment at which it is cut off in a step. Of a
pocket, the cells without any solid are its pool. The content e of these cells, the volumetric
strain at which they would be full, sinks by the demand of the whole pocket instead, and by what
cells with solid round it have gained (`CellVolume.born`); what their volumetric strain θ exceeds it
by is the void of the pocket,

    Σ V (θ − e) ≥ 0,

spread evenly over the pool. Walls squeeze a pool that is cut off after a part m of a step in what
is left of it alone. With strains that grow evenly from θ_0 on, and the demand d from the cut on,

    (1 − m) (θ − θ_0) + d ≥ 0,   e = θ_0 − d/(1 − m),

and the void is 1 − m times as large. What a cell holds of it when its solid begins to grow stays as
porosity, and where a pocket has no pool any more pores open in the cells that still freeze. Volumes
are those of solid metal, and for each body demand = fed + growth of the voids + what the walls of
the pockets gave way.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.mechanics.liquid.feeding_paths import CutOff
from castx.stateful import Array, Arrays, Numbering, Saved, number

ALONE = -2
"""Number of cells that are cut off in a region without a pool."""


class Content:
    """Content and pores of the cells of one body, and its balance of feeding.

    Args:
        comm: the ranks.
        numbering: of the cells.
        volumes: of the owned cells [m³], shape (owned,).

    Attributes:
        pocket: number of the pocket in whose pool each cell is in the trial step, −1: none, shape
            (cells,).
        pockets: volumes of the pools of the pockets [m³], equal on all ranks, shape (pockets,).
        demand: feeding demand so far [m³].
        fed: what has been fed so far [m³].
        void: present volume of all pores [m³].
        swelling: volumetric strain by which metal that swells while it freezes overfills the cells
            in the trial step, where no pool takes it, shape (cells,).
    """

    def __init__(self, comm: MPI.Intracomm, numbering: Numbering, volumes: FloatArray) -> None:
        self._comm, self._numbering, self._volumes = comm, numbering, volumes
        self.demand = self.fed = self.void = 0.0
        self._started = False
        cells = len(numbering.numbers)
        self.pocket: IntArray = np.full(cells, -1, dtype=np.int32)
        self.pockets: FloatArray = np.zeros(0)
        none: FloatArray = np.zeros(cells)
        self.swelling: FloatArray = none
        self._full, self._pores, self._shrunk = none, none, none
        self._trial_full, self._trial_pores, self._trial_shrunk = none, none, none
        self._region: IntArray = self.pocket
        self._last_region: IntArray = self.pocket
        self._last_count = self._groups = 0
        self._group: IntArray = self.pocket
        self._unfed: FloatArray = none
        self._left: FloatArray = np.ones(cells)
        self._was_pool: BoolArray = np.zeros(cells, dtype=bool)
        self._liquid: BoolArray = np.zeros(cells, dtype=bool)

    def begin(
        self,
        cut: CutOff,
        liquid: BoolArray,
        shrunk: FloatArray,
        at_cut: FloatArray,
        dilatation: FloatArray,
        gained: FloatArray | float = 0.0,
    ) -> None:
        """Find the content of the cells in a trial step; collective.

        The first state of all is full everywhere, whatever has frozen there.

        Args:
            cut: what no liquid reaches, and since when in the step.
            liquid: whether a cell has no solid, shape (cells,).
            shrunk: s min(f_s, f_c) of the cells, shape (cells,).
            at_cut: the same at the moment at which cells were cut off in the step, likewise.
            dilatation: volumetric strain of the cells at the start of the step, shape (cells,).
            gained: volumetric strain by which cells with solid take liquid of others in the step,
                shape (cells,); one value: all alike.
        """
        self._number(cut.region, liquid)
        if not self._started:
            self._started = True
            self._shrunk, self._last_region = shrunk, self._region
            self._last_count, self._was_pool = len(self.pockets), self.pocket >= 0
        self._liquid, self._trial_shrunk = liquid, shrunk
        newly = (self._last_region == -1) & (cut.group >= 0)
        self._group = np.where(newly, self._last_count + cut.group, self._last_region)
        self._groups = self._last_count + cut.groups
        unfed = (self._last_region != -1) | (self.pocket >= 0)
        self._unfed = np.where(newly, shrunk - at_cut, unfed * (shrunk - self._shrunk))
        self._left = 1.0 - cut.moment
        # Cells that were fed until the cut were full at the volume that they had.
        gained = np.where(liquid | newly | ~unfed, 0.0, gained)
        self._fill(self._unfed + gained, dilatation)

    def _number(self, region: IntArray, liquid: BoolArray) -> None:
        """Number the regions that have a pool; those without one are `ALONE`."""
        count = 1 + self._comm.allreduce(int(region.max(initial=-1)), op=MPI.MAX)
        pools = self._sums(np.where(liquid, region, -1), count, np.ones(len(region)))
        numbers = np.where(pools > 0, np.cumsum(pools > 0) - 1, ALONE).astype(np.int32)
        self._region = region.copy()
        self._region[region >= 0] = numbers[region[region >= 0]]
        self.pocket = np.where(liquid, self._region, -1)
        self.pockets = pools[pools > 0]

    def _fill(self, change: FloatArray, dilatation: FloatArray) -> None:
        """Let pools lose what freezes in them and round them, by what is not fed of the change."""
        pool, group = self.pocket >= 0, self._group
        # What freezes round a pool draws from the liquid that is left in it.
        lost = self._sums(np.where(self._liquid, -1, group), self._groups, change)
        room = self._sums(np.where(pool, group, -1), self._groups, np.ones(len(group)))
        share = np.divide(lost, room, out=np.zeros_like(lost), where=room > 0)
        drawn, alone = np.zeros(len(group)), group == ALONE
        inside = group >= 0
        drawn[inside], alone[inside] = share[group[inside]], room[group[inside]] == 0
        full = np.where(self._was_pool, self._full, dilatation - self._pores)
        self._trial_full = np.where(pool, full - (change + drawn) / self._left, 0.0)
        self._trial_pores = np.where(self._liquid, 0.0, self._pores)
        final = alone & ~self._liquid  # nothing is left from which it could draw
        self._trial_pores[final] = np.maximum(self._pores + change, 0.0)[final]
        self.swelling = np.where(final, np.maximum(-self._pores - change, 0.0), 0.0)

    def _sums(self, group: IntArray, count: int, values: FloatArray) -> FloatArray:
        """Return the sums of V times values over the cells of each group, shape (count,)."""
        owned = group[: len(self._volumes)]
        mine = owned >= 0
        weights = (self._volumes * values[: len(owned)])[mine]
        sums = np.bincount(owned[mine], weights, count).astype(np.float64)
        return np.asarray(self._comm.allreduce(sums, op=MPI.SUM))

    @property
    def was_fed(self) -> BoolArray:
        """Whether the cells were not cut off at the start of the step, shape (cells,)."""
        return np.asarray(self._last_region == -1)

    @property
    def was_trapped(self) -> BoolArray:
        """Whether the cells were in a pool at the start of the step, shape (cells,)."""
        return self._was_pool

    @property
    def pores(self) -> FloatArray:
        """Share of the cells that is void after the last accepted step, shape (cells,)."""
        return self._pores

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

        It is that of walls which move throughout the step as they do from the cut on.

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
        change, pool = self._trial_shrunk - self._shrunk, self.pocket >= 0
        fed = change - self._unfed
        again = self._liquid & ~pool
        fed[again] = (change + self._pores)[again]
        fraction = self.mean(self._left) * self.void_fraction(dilatation)
        cells = pool.copy()
        cells[pool] = porous[self.pocket[pool]]
        self._full, self._pores = self._trial_full.copy(), self._trial_pores.copy()
        self._pores[cells] = fraction[self.pocket[cells]]
        self._full[pool] = dilatation[pool] - fraction[self.pocket[pool]]
        self._shrunk, self._last_region, self._was_pool = self._trial_shrunk, self._region, pool
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
            "shrunk": self._shrunk, "region": self._last_region, "pool": self._was_pool,
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
        self._last_region = np.asarray(arrays["region"], dtype=np.int32)
        self._was_pool = np.asarray(arrays["pool"], dtype=bool)
        self._last_count = int(arrays["pockets"])
        self.demand, self.fed = float(arrays["demand"]), float(arrays["fed"])
        (self.void,) = self._totals(self._pores)
