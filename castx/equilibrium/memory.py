"""State of the equilibrium as arrays of nodes, cells and pairs.

Displacements are saved, not the unknowns v, which depend on the ranks.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from castx.arrays import FloatArray
from castx.equilibrium.equilibrium import Equilibrium
from castx.mechanics.body import BodyMechanics
from castx.stateful import (
    Array,
    Arrays,
    Saved,
    joined,
    number,
    part_of,
    restore_parts,
    saved_parts,
)


class MechanicalMemory:
    """The committed state of all bodies and of their contact.

    Args:
        bodies: by name, in the order of the layout.
        equilibrium: holds the committed unknowns, the pairs and their contact method.
    """

    def __init__(
        self,
        bodies: Mapping[str, BodyMechanics],
        equilibrium: Equilibrium,
    ) -> None:
        self._bodies, self._equilibrium = dict(bodies), equilibrium
        self._balance = equilibrium.balance
        self._transform = self._balance.transform
        self._gaps, self._contact = self._balance.gaps, self._balance.contact
        self._parts = [(n, b.block_size, b.mesh.node_numbering) for n, b in self._bodies.items()]
        self._parts += [
            (f"{name}.mid-sides", body.midsides.block_size, body.midsides.numbering)
            for name, body in self._bodies.items()
            if body.midsides is not None
        ]

    def saved(self) -> dict[str, Saved]:
        """Return the committed state; collective."""
        parts = {name: saved_parts(body.stateful_parts()) for name, body in self._bodies.items()}
        motion = self._motions(self._equilibrium.committed)
        origin = self._motions(self._balance.supports.origin)
        return {"time": number(self._balance.committed_time, of_cycle=True)} | joined(
            {"motion": motion, "anchor": origin, "bodies": joined(parts), "rows": self._rows()}
        )

    def _motions(self, unknowns: FloatArray) -> dict[str, Saved]:
        """Return the unknowns: displacement, scaled pressure, axial strain, and bubbles."""
        layout = self._transform.layout
        u = self._transform.displacements(unknowns[: layout.size_local])
        return {
            name: Saved(u[layout.local_slice(k)].reshape(-1, size).copy(), numbering)
            for k, (name, size, numbering) in enumerate(self._parts)
        }

    def _rows(self) -> dict[str, Saved]:
        """Return the saved state of the pairs: flags, and multipliers if the method has any."""
        found: dict[str, Array] = {
            "closed": self._balance.active.committed,
            "at_rest": self._gaps.at_rest,
        }
        layout = self._transform.layout
        if self._contact.layout.size_global > layout.size_global:
            found["multipliers"] = self._equilibrium.committed[layout.size_local :]
        found |= self._contact.saved()
        return {
            f"{interface.pairs.name}/{name}": Saved(values[part], interface.numbering)
            for part, interface in zip(self._gaps.slices, self._gaps.interfaces, strict=True)
            for name, values in found.items()
        }

    def restore(self, arrays: Arrays) -> None:
        """Take back a committed state; the equilibrium has to be rewound to it; collective."""
        for name, body in self._bodies.items():
            restore_parts(body.stateful_parts(), part_of(arrays, f"bodies/{name}"))
        rows = part_of(arrays, "rows")
        self._balance.committed_time = float(arrays["time"])
        self._balance.active.restore(self._of_all("closed", rows).astype(bool))
        self._contact.restore({name: self._of_all(name, rows) for name in self._contact.saved()})
        self._gaps.at_rest[:] = self._of_all("at_rest", rows)
        self._gaps.set_time(self._balance.committed_time)
        self._restore_unknowns(self._balance.supports.origin, part_of(arrays, "anchor"))
        committed, layout = self._equilibrium.committed, self._transform.layout
        self._restore_unknowns(committed, part_of(arrays, "motion"))
        if self._contact.layout.size_global > layout.size_global:
            committed[layout.size_local :] = self._of_all("multipliers", rows)

    def begin_stage(self, renewed: Collection[str]) -> None:
        """Place new bodies against the others, and let springs hold what floats there; collective.

        The equilibrium has to be rewound to it.
        """
        size = self._transform.layout.size_local
        unknowns = self._equilibrium.committed[:size]
        self._gaps.place_new_bodies(self._transform.displacements(unknowns), renewed)
        self._balance.supports.origin[:size] = unknowns

    def _restore_unknowns(self, unknowns: FloatArray, motions: Arrays) -> None:
        layout = self._transform.layout
        u = np.zeros(layout.size_local)
        for k, (name, _, _) in enumerate(self._parts):
            part = layout.local_slice(k)
            u[part] = motions[name].ravel()[: part.stop - part.start]
        unknowns[: layout.size_local] = self._transform.unknowns(u)

    def _of_all(self, name: str, rows: Arrays) -> Array:
        values: FloatArray = self._gaps.initial.copy()
        for part, interface in zip(self._gaps.slices, self._gaps.interfaces, strict=True):
            values[part] = rows[f"{interface.pairs.name}/{name}"]
        return values
