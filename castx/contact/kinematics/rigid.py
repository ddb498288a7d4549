"""Rigid bodies: not part of the equilibrium, at rest or moved along a path.

Contact with one is a constraint on the other body alone (Chiumenti, end of section 8): in the local
frame of each node the condensed method needs no coupling, and the contact force is a reaction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.mechanics.fixed_directions import SurfaceDisplacement, axes_of
from castx.tables import Table


@dataclass(frozen=True)
class RigidBody:
    """Translation of a rigid body.

    Attributes:
        name: of the body.
        path: displacement in each direction over time [m].
    """

    name: str
    path: tuple[Table, ...]

    def displacement(self, time: float) -> FloatArray:
        """Return the displacement at a time [m], shape (dimension,)."""
        return np.array([float(table(time)) for table in self.path])


def rigid_body(name: str, model: str, conditions: Sequence[SurfaceDisplacement]) -> RigidBody:
    """Return the body that moves by the displacement conditions on its surfaces.

    Raises:
        CaseError: conditions that a translation cannot follow.
    """
    axes = axes_of(model)
    path: dict[str, Table] = {}
    for condition in conditions:
        place = f"displacement {condition.direction!r} on {name}/{condition.surface}"
        if condition.value is None:
            raise CaseError(f"{place} is uniform, but the body is rigid; leave it out")
        moves = np.any(condition.value.values != 0.0)
        if condition.direction not in axes and not moves:
            continue
        if condition.direction not in axes:
            raise CaseError(
                f"{place} moves a rigid body; give it along the axes {', '.join(axes)}"
            )
        given = path.setdefault(condition.direction, condition.value)
        if not _equal(given, condition.value):
            raise CaseError(f"{place} contradicts that on another surface of the rigid body")
    if model == "axisymmetric" and "r" in path and np.any(path["r"].values != 0.0):
        raise CaseError(f"rigid body {name!r} cannot move along r in an axisymmetric model")
    rest = Table.constant(0.0)
    return RigidBody(name, tuple(path.get(axis, rest) for axis in axes))


def _equal(a: Table, b: Table) -> bool:
    return np.array_equal(a.arguments, b.arguments) and np.array_equal(a.values, b.values)
