"""Largest principal stress over tensile strength since a cell became solid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.cracking import cold_crack_index
from castx.foundry.front.levels import ROUNDING
from castx.foundry.stress.stage_ends import SolidState
from castx.stateful import Arrays, Saved
from castx.tables import Table

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


class BodyColdCracks:
    """The cold-crack index of the cells of one body, the largest σ_1/R_m(T) of all accepted steps.

    It counts from when all of a cell is solid; melting erases it.

    Args:
        body: its mesh.
        strength: R_m over temperature [Pa].
        melts: whether the body melts.
    """

    def __init__(self, body: BodyMesh, strength: Table, melts: bool) -> None:
        self._body, self._strength, self._melts = body, strength, melts
        self._cell_nodes = body.nodes.dofmap.list
        self.index: FloatArray = np.full(len(self._cell_nodes), np.nan)
        """Of the local cells, not a number while they are not solid, (cells,)."""

    def update(self, snapshot: SolidState) -> None:
        """Take over the state after an accepted step."""
        name = self._body.name
        if name in snapshot.process.renewed:
            self.index[:] = np.nan
        temperature = snapshot.nodal(name, "temperature")[self._cell_nodes]
        strength = self._strength(temperature).mean(axis=1)
        stress = snapshot.cellwise(name, "largest_principal_stress")
        self.index = np.fmax(self.index, cold_crack_index(stress[None], strength[None]))
        if self._melts:
            fraction = snapshot.nodal(name, "solid_fraction")[self._cell_nodes].min(axis=1)
            self.index[fraction < 1.0 - ROUNDING] = np.nan

    def saved(self) -> dict[str, Saved]:
        """Return the index of the cells."""
        return {"index": Saved(self.index, self._body.cell_numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Restore the index of the cells."""
        self.index = arrays["index"]
