"""An iterate of the nonlinear problem as the pairs see it, and the rows on which they act."""

from __future__ import annotations

from dataclasses import dataclass

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class PairIterate:
    """An iterate of the nonlinear problem.

    Attributes:
        x: the unknowns.
        rows: owned rows before the pairs act [N].
        gaps: of all pairs [m], shape (pairs,).
        closed: the present set of closed pairs, shape (pairs,).
        stiffness: force per length of pairs and motions that have none of their own [N/m].
    """

    x: PETSc.Vec
    rows: FloatArray
    gaps: FloatArray
    closed: BoolArray
    stiffness: float


class ConstrainedRows:
    """Owned rows: sums of forces [N], and of constrained unknowns the distance from their place.

    Attributes:
        forces: sums of forces [N], shape (owned,).
        constrained: unknowns with a Dirichlet condition, shape (owned,).
        violation: their distance from their place [m], shape (owned,).

    Args:
        forces: owned rows, changed in place.
    """

    def __init__(self, forces: FloatArray) -> None:
        self.forces = forces
        self.constrained: BoolArray = np.zeros(len(forces), dtype=bool)
        self.violation: FloatArray = np.zeros(len(forces))

    def constrain(self, local: IntArray, violation: FloatArray) -> None:
        """Constrain unknowns of local numbers that are this far from their place [m]."""
        self.constrained[local] = True
        self.violation[local] = violation
