"""Grains with a binder, as moulding sand: keys of their yield surface, and its numbers at points.

Shear is borne by friction, which grows with the pressure, and by the cohesion of the binder, up to
the cone of Drucker and Prager; tension up to a cut-off of the mean stress:

    q + μ p ≤ k,   p ≤ t,

with q = √(3/2) ‖s‖ and the mean stress p, positive in tension. In compression of a cylinder the
cone meets the friction angle φ and the cohesion c of Mohr and Coulomb,

    μ = 6 sin φ/(3 − sin φ),   k = 6 c cos φ/(3 − sin φ),

so that it is crushed without side pressure at 2 c cos φ/(1 − sin φ). Nothing holds a mean stress
above that of the tip of the cone, k/μ.

Sources: D. C. Drucker, W. Prager, Quarterly of Applied Mathematics 10 (1952) 157; for the match
with Mohr and Coulomb E. A. de Souza Neto, D. Perić, D. R. J. Owen, Computational Methods for
Plasticity (2008), section 6.4.4; for the cut-off FLAC3D, Theory and Background, Drucker-Prager
model.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import Description, Quantity, over_temperature
from castx.input.problems import Problem
from castx.input.units import ANGLE, STRESS, TIME
from castx.materials.rules.key import PeoplesUnit
from castx.tables import Table

GRANULAR = "drucker-prager"
"""Name of the law of a body that yields so."""


class GranularData(Description):
    """Yield surface of Drucker and Prager with a tension cut-off.

    A binder that has burnt does not come back: cohesion and cut-off are those of the highest
    temperature so far.

    Attributes:
        cohesion: c [Pa].
        friction_angle: φ [°].
        dilatancy_angle: φ of the flow, by which grains that shear move apart [°]; 0: none.
        tension_cut_off: t [Pa]; None: the tip of the cone.
        relaxation_time: in which a stress beyond the surface comes back to it [s]; 0: at once.
    """

    cohesion: Annotated[Table, over_temperature(STRESS, least=0.0), PeoplesUnit("MPa", 1e-6)]
    friction_angle: Annotated[float, Quantity(ANGLE, least=0.0, below=90.0)]
    dilatancy_angle: Annotated[float, Quantity(ANGLE, least=0.0, below=90.0)] = 0.0
    tension_cut_off: (
        Annotated[Table, over_temperature(STRESS, least=0.0), PeoplesUnit("MPa", 1e-6)] | None
    ) = None
    relaxation_time: Annotated[float, Quantity(TIME, least=0.0)] = 0.0

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a dilatancy that gains energy, and grains that bear no shear at all."""
        if self.dilatancy_angle > self.friction_angle:
            text = f"{self.dilatancy_angle:g}° lies above friction_angle, {self.friction_angle:g}°"
            yield Problem(("dilatancy_angle",), f"{text}, so that flow would gain energy; lower it")
        if self.friction_angle == 0 and not self.cohesion.values.any():
            text = "zero without any friction_angle, so that no shear would be borne; raise one"
            yield Problem(("cohesion",), text)


class GranularSurface(NamedTuple):
    """Yield surface at integration points.

    Attributes:
        friction: μ.
        dilatancy: slope of the flow, dθ_p = dilatancy dγ.
        strength: k [Pa], shape (points,).
        cut_off: t, not above k/μ [Pa], shape (points,).
    """

    friction: float
    dilatancy: float
    strength: FloatArray
    cut_off: FloatArray


def granular_surface(data: GranularData, hottest: FloatArray) -> GranularSurface:
    """Return the yield surface after highest temperatures [°C], shape (points,)."""
    friction = _slope(data.friction_angle)
    angle = np.radians(data.friction_angle)
    strength = data.cohesion(hottest) * 6 * np.cos(angle) / (3 - np.sin(angle))
    cut_off = np.full_like(strength, np.inf) if friction == 0 else strength / friction
    if data.tension_cut_off is not None:
        cut_off = np.minimum(cut_off, data.tension_cut_off(hottest))
    return GranularSurface(friction, _slope(data.dilatancy_angle), strength, cut_off)


def _slope(angle: float) -> float:
    """Return μ of an angle [°]."""
    sine = float(np.sin(np.radians(angle)))
    return 6 * sine / (3 - sine)
