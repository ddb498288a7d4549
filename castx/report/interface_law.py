"""The curve of a heat-transfer law of an interface over gap or pressure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from castx.arrays import FloatArray
from castx.case.heat_transfer import InterfaceHeat
from castx.errors import CaseError
from castx.input.problems import Refusal, summary
from castx.transfer.conductance import Faces
from castx.transfer.pair_state import PairState


def heat_transfer_coefficient(
    heat: Mapping[str, Any],
    gap: ArrayLike = 0.0,
    pressure: ArrayLike = 0.0,
    *,
    secondary: ArrayLike = 600.0,
    primary: ArrayLike = 300.0,
    solid_fraction: float = 0.0,
    time: float = 0.0,
) -> FloatArray:
    """Return the heat-transfer coefficient of an interface [W/m²/K] without its radiation.

    >>> import castx
    >>> law = {"law": "limited", "closed": 2300, "gas_conductivity": "0.05 W/m/K"}
    >>> castx.heat_transfer_coefficient(law, gap=[0.0, 100e-6, 200e-6])
    array([2300.,  500.,  250.])

    Args:
        heat: the `heat` of an interface as in a case file.
        gap: opening of the surfaces [m], any shape.
        pressure: contact pressure of closed surfaces [Pa].
        secondary: temperature of the surface of the first body [°C].
        primary: temperature of the surface of the second body [°C].
        solid_fraction: of the first body.
        time: [s].

    Raises:
        CaseError: the law cannot be accepted, or is perfect contact, which has no coefficient.
    """
    try:
        described = InterfaceHeat.read(heat)
    except Refusal as refusal:
        raise CaseError(summary("heat", refusal.problems, heat)) from None
    if described.declared.exchange == "perfect":
        raise CaseError("perfect contact has no heat-transfer coefficient: it is infinite")
    given = (np.asarray(values, dtype=np.float64) for values in (gap, pressure, secondary, primary))
    opening, pressed, hot, cold = np.broadcast_arrays(*given)
    state = PairState.of(opening.ravel(), pressed.ravel())
    faces = Faces.at_temperatures(hot.ravel(), cold.ravel(), time, solid_fraction)
    found = described.conduction_law()(state, faces).coefficient.value
    return found.reshape(opening.shape)
