"""Block of trapped liquid in the Jacobian, in the unknowns of the contact method."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.transform import ConstraintTransform
from castx.mechanics.assembly import BodyAssembly


class PocketBlock:
    """The stiffness K of full pockets, as Pᵀ K P for the unknowns v of u = P v.

    Args:
        assembly: of the bodies, with what their pockets add.
        transform: change of unknowns.
    """

    def __init__(self, assembly: BodyAssembly, transform: ConstraintTransform) -> None:
        self._assembly, self._transform = assembly, transform
        self._corrections = assembly.coupled_corrections()

    def __call__(self, x: FloatArray, y: FloatArray) -> None:
        """Add the block times owned unknowns x to rows y, the first of which are v; collective."""
        if not self._assembly.has_pockets:
            return
        count = self._assembly.layout.size_local
        u = self._transform.displacements(x[:count])
        forces = np.zeros(count)
        for correction in self._corrections:
            correction(u, forces)
        y[:count] += self._transform.forces_on_unknowns(forces)
