"""Copies of the wanted fields of one moment, and of a moment between two others."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from castx.arrays import FloatArray

FieldsOfBodies = dict[str, dict[str, FloatArray]]


@dataclass
class FieldCopies:
    """Copies of the wanted fields of one moment: arrays of the pieces of this rank by body.

    Bodies that are removed have none. Those of the foundry are found when they are written.
    """

    time: float
    phase: tuple[int, int]
    nodal: FieldsOfBodies = field(default_factory=dict)
    cellwise: FieldsOfBodies = field(default_factory=dict)


def between(before: FieldCopies, after: FieldCopies, time: float) -> FieldCopies:
    """Return the fields of a moment within a step, linear in time.

    Args:
        before: those of the start of the step.
        after: those of its end, with the same bodies.
        time: of the moment [s].
    """
    if time == after.time:
        return after
    share = (time - before.time) / (after.time - before.time)
    return FieldCopies(
        time,
        after.phase,
        _mixed(before.nodal, after.nodal, share),
        _mixed(before.cellwise, after.cellwise, share),
    )


def _mixed(before: FieldsOfBodies, after: FieldsOfBodies, share: float) -> FieldsOfBodies:
    return {
        body: {
            name: np.asarray((1.0 - share) * before[body][name] + share * values)
            for name, values in fields.items()
        }
        for body, fields in after.items()
    }
