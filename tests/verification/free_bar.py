"""A free bar that is heated, and how long it has to be: by its own mean expansion.

A bar of length L that is free and heated from T_0 grows by

    u = L [α(T)(T − T_ref) − α(T_sf)(T_sf − T_ref)],

T_sf being `stress_free` if the case gives one, else T_0, and α and T_ref those of the database.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from castx.materials.lookup import find_material
from castx.process.state import State
from tests.coupled_cases import nodal

LENGTH, START, HOT = 0.02, 100.0, 500.0


def bar(metal: str, history: list[list[float]], **changes: Any) -> dict[str, Any]:
    """Return a bar on rollers whose temperature follows a table."""
    return {
        "geometry": {
            "generator": "slab", "model": "plane-stress",
            "length": LENGTH, "width": 0.01, "size": 0.005,
        },
        "materials": {"metal": {"extends": metal, **changes}},
        "bodies": [
            {"name": "casting", "material": "metal", "temperature_history": history},
        ],
        "boundaries": [
            {"on": f"casting/{side}", "displacement": {"normal": 0.0}}
            for side in ("wall", "bottom")
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": history[-1][0]},
    }  # fmt: skip


def ends(states: Iterable[State]) -> list[float]:
    """Return the displacement of the far end after each step [m]."""
    found = []
    for state in states:
        move = nodal(state, "casting", "displacement")[:, 0]
        found.append(float(move[np.argmax(np.abs(move))]))
    return found


def growth(metal: str, start: float, temperature: float) -> float:
    """Return the strain of a metal between two temperatures [°C], by its mean expansion."""
    material = find_material(metal)
    table, reference = material.expansion, material.expansion_reference or 0.0
    assert table is not None

    def length(at: float) -> float:
        return float(table(at)) * (at - reference)

    return length(temperature) - length(start)
