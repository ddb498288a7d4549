"""Heat of plastic work, D = χ s:ε̇_vp (Chiumenti, section 2.3)."""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.body import BodyMechanics
from castx.stateful import Arrays, Saved


class Dissipation:
    """Nodal powers of plastic work as sources of the heat problem, committed and trial.

    D = χ s:ε̇_vp [W/m³], χ the share of plastic work that becomes heat.

    The heat of a pass has the powers of the pass before as sources, that of the first pass of a
    step those of the last step.

    Args:
        comm: ranks.
        bodies: mechanics of all bodies; those that cannot flow are left out.
    """

    def __init__(self, comm: MPI.Intracomm, bodies: Mapping[str, BodyMechanics]) -> None:
        self._comm = comm
        self._bodies = {n: body for n, body in bodies.items() if body.dissipated_fraction > 0.0}
        self.powers: dict[str, FloatArray] = {
            name: np.zeros(body.owned_nodes) for name, body in self._bodies.items()
        }
        """χ s:ε̇_vp at the owned nodes of the bodies that flow [W]."""
        self._committed = dict(self.powers)

    def update(self) -> float:
        """Take the powers of the present stresses; return their change, summed over nodes [W]."""
        change = 0.0
        for name, body in self._bodies.items():
            found = body.dissipated_fraction * body.nodal_plastic_power()
            change += float(np.abs(found - self.powers[name]).sum())
            self.powers[name] = found
        return float(self._comm.allreduce(change, op=MPI.SUM))

    def commit(self) -> None:
        """Accept the present powers as the start of the next step."""
        self._committed = dict(self.powers)

    def saved(self) -> dict[str, Saved]:
        """Return the committed powers [W]."""
        return {
            name: Saved(power, self._bodies[name].mesh.node_numbering)
            for name, power in self._committed.items()
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore committed powers [W]."""
        self._committed = {
            name: arrays[name][: body.owned_nodes] for name, body in self._bodies.items()
        }
        self.rewind()

    def rewind(self) -> None:
        """Return to the powers of the last accepted step."""
        self.powers = dict(self._committed)
