"""Change of the stored heat and of the solid fraction since the last accepted state."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.coupling.temperatures import Temperatures

ROUNDING = 1e-12
"""Share of the stored heat below which none moves: at the end of a run the bodies rest."""


SHARE_OF_MELT = 0.4
"""What freezes of the melt of a mush that flows counts by this beside what freezes of its body:
pores open in the last of it. A step that freezes a tenth of it is like one of 0.04 of all."""
LAST_MELT = 0.02
"""Share of a body below which less melt counts like so much."""


@dataclass(frozen=True)
class StepErrors:
    """Errors by the steps, estimated.

    Attributes:
        temperature: largest one of a node if all heat steps had been as long as these [K].
        gap: largest one of a pair by this step [m].
        strain: of the equivalent viscoplastic strain by this step, root mean square over what is
            solid of a body, the largest of all bodies.
        made: largest one of the temperature of a node by all steps so far [K].
        substeps: heat steps inside the step.
    """

    temperature: float = 0.0
    gap: float = 0.0
    strain: float = 0.0
    made: float = 0.0
    substeps: int = 1


NO_ERRORS = StepErrors()


@dataclass(frozen=True)
class StepChange:
    """Change of the state over a step.

    Attributes:
        passes: passes between heat and mechanics that it took.
        temperature: largest change of a node whose temperature is not prescribed [K].
        solid_fraction: largest change of a node.
        mean_solid_fraction: largest change of the mean over a body.
        skin: largest mean change over an interface of the share of metal that bears at its wall.
        errors: of the step; none where nobody asks for them.
        settled: passes that say how hard it was, see `SETTLED` of `coupling.passes`.
        agreed: whether heat and mechanics agree; else the step was given up.
    """

    passes: int
    temperature: float
    solid_fraction: float
    mean_solid_fraction: float = 0.0
    skin: float = 0.0
    errors: StepErrors = NO_ERRORS
    settled: int = 1
    agreed: bool = True


class ThermalChange:
    """Change of enthalpy and solid fraction of all bodies since the last accepted state.

    Args:
        comm: ranks.
        heat: temperatures of all bodies.
        volumes: of the owned nodes of each body [m³].
        flowing: names of the bodies whose melt flows through the mush.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        heat: Temperatures,
        volumes: Mapping[str, FloatArray],
        flowing: Collection[str] = (),
    ) -> None:
        self._comm, self._heat, self._volumes = comm, heat, volumes
        self._of_melt = np.array([SHARE_OF_MELT * (name in flowing) for name in volumes])
        self.commit()

    def commit(self) -> None:
        """Store the present state as the reference of later changes."""
        self._solid_fraction, self._stored = self._present_solid_fraction(), self._present_heat()

    def _present_solid_fraction(self) -> FloatArray:
        return np.concatenate([f.x.array for f in self._heat.solid_fraction.values()])

    def _present_heat(self) -> FloatArray:
        """Return the enthalpies of the owned nodes [J], of none without the heat equation."""
        parts = [
            self._volumes[name] * function.x.array[: len(self._volumes[name])]
            for name, function in self._heat.enthalpy.items()
        ]
        return np.concatenate([np.zeros(0), *parts])

    def largest_of_solid_fraction(self) -> float:
        """Return the largest change of the solid fraction of a node; collective."""
        change = np.abs(self._present_solid_fraction() - self._solid_fraction)
        return float(self._comm.allreduce(float(change.max(initial=0.0)), op=MPI.MAX))

    def largest_of_mean_solid_fraction(self) -> float:
        """Return the largest volume of a body that froze or melted, as a share of it; collective.

        Unlike the change of a node it does not depend on the size of the elements. Zero where
        temperatures are prescribed. Where melt flows `SHARE_OF_MELT` of its share of what was melt
        counts too.
        """
        if not self._heat.enthalpy:
            return 0.0
        sums, first = np.zeros((len(self._volumes), 3)), 0
        change = np.abs(self._present_solid_fraction() - self._solid_fraction)
        for row, (name, function) in enumerate(self._heat.solid_fraction.items()):
            volumes = self._volumes[name]
            own = slice(first, first + len(volumes))
            melt = volumes @ (1.0 - self._solid_fraction[own])
            sums[row] = volumes @ change[own], volumes.sum(), melt
            first += len(function.x.array)
        moved, whole, melt = self._comm.allreduce(sums, op=MPI.SUM).T
        whole = np.where(whole > 0.0, whole, 1.0)
        of_melt = self._of_melt * moved / np.maximum(melt, LAST_MELT * whole)
        return float(np.maximum(moved / whole, of_melt).max(initial=0.0))

    def share(self, heat: float) -> float:
        """Return an amount of heat [J] relative to all heat that has moved; collective."""
        local = [np.abs(self._present_heat() - self._stored).sum(), np.abs(self._stored).sum()]
        moved, stored = self._comm.allreduce(np.array(local), op=MPI.SUM)
        moved = max(float(moved), ROUNDING * float(stored), heat)
        return heat / moved if moved > 0 else 0.0
