"""Supports of bodies that contact does not hold: springs and in-gates, and their forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.iterate import ConstrainedRows
from castx.contact.kinematics.transform import ConstraintTransform
from castx.equilibrium.supports.in_gates import InGate
from castx.equilibrium.supports.resultants import NodalResultants, Resultant
from castx.equilibrium.supports.springs import FloatingMotions, SpringSupport
from castx.mechanics.body import BodyMechanics


class Supports:
    """Springs and in-gates of all bodies.

    Attributes:
        origin: unknowns at which the springs are without force, shape (owned,).
        springs: on the motions that nothing holds; None: nothing floats.

    Args:
        transform: change of unknowns of all bodies.
        bodies: in the order of the layout.
        floating: finds the motions that nothing holds; None: they get no springs.
        gates: hold bodies that have lost all contact.
        size: number of owned unknowns.
    """

    def __init__(
        self,
        transform: ConstraintTransform,
        bodies: Sequence[BodyMechanics],
        floating: FloatingMotions | None,
        gates: Sequence[InGate],
        size: int,
    ) -> None:
        self._size, self._gates, self._floating = transform.layout.size_local, list(gates), floating
        self._resultants = NodalResultants(transform, bodies)
        self.origin: FloatArray = np.zeros(size)
        self.springs: SpringSupport | None = None
        self._committed: SpringSupport | None = None
        self._place: FloatArray = np.zeros(size)

    @property
    def floating(self) -> int:
        """Number of motions on springs."""
        return 0 if self.springs is None else len(self.springs.motions)

    @property
    def motions(self) -> FloatArray | None:
        """The rigid motions of all bodies, shape (motions, owned); None: there are no springs."""
        return None if self._floating is None else self._floating.motions

    def begin(self, closed: BoolArray) -> None:
        """Begin a solve from the accepted set of closed pairs."""
        for gate in self._gates:
            gate.begin(closed)

    def constrain(self, x: FloatArray, rows: ConstrainedRows) -> None:
        """Fix the nodes that in-gates grip at their last accepted places."""
        for gate in self._gates:
            if gate.acts:
                rows.constrain(gate.local, x[gate.local] - self._place[gate.local])

    def find_springs(self, constrained: BoolArray, values: FloatArray | None) -> None:
        """Put springs on the motions that nothing holds.

        Args:
            constrained: owned unknowns with a Dirichlet condition.
            values: further constraint rows of this rank for each motion, shape (motions, rows).
        """
        if self._floating is not None:
            self.springs = self._floating.find(constrained, values)

    def change(self, closed: BoolArray, settled: bool) -> bool:
        """Let in-gates grip bodies without contact and release others; return whether any did.

        Args:
            closed: the present set of closed pairs.
            settled: whether the set does not change any more.
        """
        return any([gate.update(closed, settled) for gate in self._gates])

    def spring_forces(self, x: FloatArray) -> FloatArray | None:
        """Return the owned spring forces at unknowns x; None: there are none."""
        return None if self.springs is None else self.springs.force(x - self.origin)

    def norm(self, x: FloatArray, rows: FloatArray) -> float:
        """Return the norm of all forces of springs and gates [N]; collective.

        Args:
            x: owned unknowns.
            rows: before the pairs act [N].
        """
        springs = 0.0 if self.springs is None else self.springs.resultant(x - self.origin)
        gates = self._resultants.of(self._gate_forces(rows))
        return springs + sum(float(np.linalg.norm(body.force)) for body in gates.values())

    def on_bodies(self, x: FloatArray, rows: FloatArray) -> dict[str, Resultant]:
        """Return the forces and moments on each body by its name, as in `norm`; collective."""
        forces, springs = self._gate_forces(rows), self.spring_forces(x)
        if springs is not None:
            forces = forces - springs[: len(forces)]
        return self._resultants.of(forces)

    def _gate_forces(self, rows: FloatArray) -> FloatArray:
        forces = np.zeros(self._size)
        for gate in self._gates:
            if gate.acts:
                forces[gate.local] = rows[gate.local]
        return forces

    def commit(self, x: FloatArray) -> None:
        """Accept the state at owned unknowns x as the start of the next step.

        Motions that something else holds begin there when they come onto springs, so that a body
        that is set free stays where it was.
        """
        stretch = 0.0 if self.springs is None else self.springs.amplitudes(x - self.origin)
        self._place, self._committed = x.copy(), self.springs
        self.origin = x.copy()
        if self.springs is not None:
            # What hangs on springs stays on them: else it would fall a little in every step.
            self.origin -= stretch @ self.springs.motions

    def rewind(self, x: FloatArray) -> None:
        """Return to the accepted state, whose owned unknowns are x."""
        self._place, self.springs = x.copy(), self._committed

    def adopt(self) -> None:
        """Start from a state of another contact method, whose springs are not these."""
        self._committed = None
