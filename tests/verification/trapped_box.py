"""A box of an alloy of the database in a mould with a lid, which cuts its liquid off."""

from __future__ import annotations

from typing import Any

from tests.coupled_cases import merged

VISCOPLASTIC = "thermo-elasto-viscoplastic"


def box(*changes: dict[str, Any], cells: str = "simplices", lid: bool = True) -> dict[str, Any]:
    """Return a box of an alloy of the database, 40 × 30 mm, in a mould with a lid."""
    data = {
        "geometry": {
            "generator": "box_in_mould", "model": "plane-strain", "cells": cells,
            "box": [0.04, 0.03], "wall": 0.015, "lid": lid, "size": 0.005,
        },
        "materials": {"alloy": {"extends": "AlSi7Mg"},
                      "die": {"extends": "steel-H13", "stress_free": 200}},
        "bodies": [
            {"name": "casting", "material": "alloy", "temperature": 640, "law": VISCOPLASTIC},
            {"name": "mould", "material": "die", "temperature": 200},
        ],
        "interfaces": [
            {"bodies": ["casting", "mould"],
             "heat": {"law": "limited", "closed": 3000, "gas_conductivity": 0.05}},
        ],
        "boundaries": [{"on": "mould/base", "displacement": {"y": 0}}],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 30.0},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data
