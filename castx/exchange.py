"""Heat exchange between the facing nodes of two bodies (Chiumenti, section 9)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.layout import Layout
from castx.pairs import NodePairs
from castx.remote import RemoteEntries
from castx.tables import FloatArray

IntArray = npt.NDArray[np.int32]


@dataclass(frozen=True)
class HeatExchange:
    """How heat crosses one interface.

    Attributes:
        name: of the interface: "casting/mould".
        pairs: facing nodes.
        kind: "resistance": given by the caller of each step; "perfect": facing nodes have one
            temperature; "none": no heat crosses.
    """

    name: str
    pairs: NodePairs
    kind: Literal["resistance", "perfect", "none"] = "resistance"


class PairExchange:
    """Heat between the nodes of one interface: (T_secondary − T_primary) S / R for each pair.

    Args:
        layout: numbering of the nodes of all bodies.
        vector: any vector of the layout.
        secondary: number of the secondary body.
        primary: number of the primary body.
        description: pairs of the interface.
    """

    def __init__(
        self,
        layout: Layout,
        vector: PETSc.Vec,
        secondary: int,
        primary: int,
        description: HeatExchange,
    ) -> None:
        pairs = description.pairs
        self.name = description.name
        self.areas = pairs.areas
        self.local = layout.local_slice(secondary).start + pairs.secondary_local
        self.secondary_dofs = layout.dofs(secondary, pairs.secondary_nodes, 0)
        self.primary_dofs = layout.dofs(primary, pairs.primary_nodes, 0)
        self.resistance: FloatArray = np.full(len(self.areas), np.inf)
        self._primary = RemoteEntries(vector, self.primary_dofs)

    def set_resistance(self, start: FloatArray, end: FloatArray, part: float) -> None:
        """Set R = 1/h, linear in time over the step.

        Args:
            start: at the start of the step, shape (pairs,) [m² K/W]; infinite: nothing passes.
            end: at its end.
            part: of the step that has passed, between 0 and 1.
        """
        self.resistance = end if part >= 1.0 else (1.0 - part) * start + part * end

    def heat(self, temperature: PETSc.Vec) -> FloatArray:
        """Return the heat from the secondary to the primary node of each pair [W]."""
        difference = temperature.array_r[self.local] - self._primary.get(temperature)
        return np.asarray(self.areas / self.resistance * difference)

    def add_heat(self, heat: FloatArray, balance: PETSc.Vec) -> None:
        """Add what leaves the nodes to their balance: `heat` at the secondary, −`heat` there."""
        balance.array[self.local] += heat
        self._primary.add(-heat, balance)

    def derivatives(self, temperature_slope: PETSc.Vec) -> FloatArray:
        """Return the derivatives of the balance of both nodes over both unknowns.

        Args:
            temperature_slope: of the nodes over their unknown.

        Returns:
            For each pair the rows secondary, primary and in them the columns secondary,
            primary, shape (pairs, 2, 2).
        """
        conductance = self.areas / self.resistance
        secondary = conductance * temperature_slope.array_r[self.local]
        primary = conductance * self._primary.get(temperature_slope)
        entries = np.empty((len(conductance), 2, 2))
        entries[:, 0, 0], entries[:, 0, 1] = secondary, -primary
        entries[:, 1, 0], entries[:, 1, 1] = -secondary, primary
        return entries
