"""History of the integration points, from the end of one step to the start of the next.

It is the history of the solid there. What is born dilutes it, since new solid has no past (`growth`
says how); with the last solid it melts away.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.stateful import Arrays, Saved


class SolidStrain(NamedTuple):
    """Strains of solid at the points.

    Attributes:
        elastic: elastic strain E, shape (points, components).
        plastic: viscoplastic strain, shape (points, components).
        equivalent: its equivalent ξ, the integral of its rate, shape (points,).
    """

    elastic: FloatArray
    plastic: FloatArray
    equivalent: FloatArray


class PointHistory(NamedTuple):
    """State of the points at the end of a step.

    Attributes:
        elastic: elastic strain E of all that bears, shape (points, components).
        plastic: its viscoplastic strain, shape (points, components).
        equivalent: the equivalent ξ of that, the integral of its rate, shape (points,).
        strain: deviatoric strain at the end of the last step, shape (points, components).
        softening: secant shear modulus over the elastic one, shape (points,).
        shape: sum of all de^c, the deviatoric part of contraction, shape (points, components).
        mush: strains of the mush alone where solid is beside it (`mush`); None: it has none.
    """

    elastic: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    strain: FloatArray
    softening: FloatArray
    shape: FloatArray
    mush: SolidStrain | None = None

    @property
    def mean(self) -> SolidStrain:
        """Strains of all that bears."""
        return SolidStrain(self.elastic, self.plastic, self.equivalent)

    @property
    def of_mush(self) -> SolidStrain:
        """Strains of the mush, which are those of all where it is alone."""
        return self.mean if self.mush is None else self.mush

    def saved(self, points: IntegrationPoints) -> dict[str, Saved]:
        """Return the arrays for a checkpoint, by cell."""
        arrays = self.arrays()
        return {
            name: Saved(points.by_cell(values), points.numbering) for name, values in arrays.items()
        }

    def arrays(self) -> dict[str, FloatArray]:
        """Return all arrays by name."""
        mush = {} if self.mush is None else self.mush._asdict()
        own = {name: values for name, values in self._asdict().items() if name != "mush"}
        return own | {f"mush_{name}": values for name, values in mush.items()}

    def restored(self, arrays: Arrays) -> PointHistory:
        """Return the history that arrays of `saved` hold, in the shapes of this one."""
        found: dict[str, Any] = {
            name: arrays[name].reshape(own.shape) for name, own in self.arrays().items()
        }
        if self.mush is not None:
            names = SolidStrain._fields
            found["mush"] = SolidStrain(*(found.pop(f"mush_{name}") for name in names))
        return PointHistory(**found)

    @classmethod
    def initial(cls, points: IntegrationPoints, *, mush: bool = False) -> PointHistory:
        """Return the history of an unstrained body.

        Args:
            points: its integration points.
            mush: whether mush beside solid has a past of its own.
        """
        none = np.zeros((points.count, points.components))
        own = cls(none, none, np.zeros(points.count), none, np.ones(points.count), none)
        return own._replace(mush=own.mean) if mush else own
