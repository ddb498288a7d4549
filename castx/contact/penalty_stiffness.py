"""Penalties: given, or by the present stiffness of the softer side of an interface.

The penalty must be large beside the stiffness of the nodes that it holds, or they give way, and not
much larger, or it spoils the matrix. Nodes change by orders of magnitude while a casting freezes,
so ε follows them from step to step (Jaouen and Bellet 1998). Their stiffness per area, about E/h,
is the diagonal of the assembled matrix over the contact area, its mean over the pairs of the
interface: a number of its own for each pair would spoil the patch test on uneven meshes, and a mean
over the area would be that of the coarse elements far from a small contact.

A melt has hardly any stiffness, and a penalty by it would let the wall move into it: the metal
would freeze with that error in its gap. So no body counts as softer than its solid as a whole, G/L.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.solvers.layout import Layout
from castx.solvers.remote_entries import RemoteEntries

FACTOR = 10.0
"""Penalty in units of the stiffness per area: pairs give way by about a tenth of what an element
does."""


class PenaltyStiffness:
    """Penalties by the softer side, and given ones where there are any.

    Attributes:
        springs: ε S of all rows as last updated, zero where no pair is free [N/m], shape (rows,).

    Args:
        layout: numbering of the displacements of all bodies.
        body_names: names of the bodies in the order of the layout; others are rigid.
        dimension: number of displacement components.
        gaps: the pairs of all interfaces.
        given: ε [Pa/m], not a number where it follows the stiffness, shape (rows,).
        moduli: G/L of the bodies, the least that counts as their stiffness per area [Pa/m].
    """

    def __init__(
        self,
        layout: Layout,
        body_names: Sequence[str],
        dimension: int,
        gaps: Gaps,
        given: FloatArray,
        moduli: Sequence[float],
    ) -> None:
        self._gaps, self._given, self._comm = gaps, given, layout.comm
        self.springs: FloatArray = np.zeros(len(gaps.free))
        names = list(body_names)
        vector = layout.create_vector()
        self._sides = []
        for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
            pairs, index = interface.pairs, interface.index
            sides = ((pairs.secondary, pairs.secondary_nodes), (pairs.primary, pairs.primary_nodes))
            for name, nodes in sides:
                if name in names:
                    numbers = [
                        layout.dofs(names.index(name), nodes[index], k) for k in range(dimension)
                    ]
                    entries = [RemoteEntries(vector, of) for of in numbers]
                    self._sides.append((part, entries, moduli[names.index(name)]))
        vector.destroy()

    def update(self, A: PETSc.Mat) -> None:
        """Evaluate the springs for the present matrix A of the bodies; collective."""
        self.springs = np.where(self._gaps.free, self.penalties(A) * self._gaps.areas, 0.0)

    def penalties(self, A: PETSc.Mat) -> FloatArray:
        """Return ε [Pa/m] of all rows: `FACTOR` times the stiffness per area of the softer side."""
        diagonal = A.getDiagonal()
        softest = np.full(len(self._given), np.inf)
        for part, entries, least in self._sides:
            nodal = np.mean([entry.get(diagonal) for entry in entries], axis=0)
            areas = self._gaps.areas[part]
            local = np.array([np.sum(nodal / areas), len(areas)])
            total, count = self._comm.allreduce(local, op=MPI.SUM)
            stiffness = max(total / count, least)
            softest[part] = np.minimum(softest[part], stiffness)
        diagonal.destroy()
        return np.where(np.isnan(self._given), FACTOR * softest, self._given)
