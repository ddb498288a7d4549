"""A bar in uniaxial stress as a case file describes it, in every model and formulation that flows.

Held or moved at its ends, its sides free: along x in plane stress, in generalised plane strain (the
resultant of the third direction is zero) and in space, along z as an axisymmetric rod.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from tests import coupled_cases

LENGTH = 0.04


class Kind(NamedTuple):
    """Model, cells and formulation of a bar."""

    model: str
    formulation: str = "mixed"
    stabilisation: str = "osgs"
    cells: str = "simplices"


KINDS = {
    "plane stress": Kind("plane-stress", "displacement"),
    "plane stress quadrilaterals": Kind("plane-stress", "displacement", cells="quadrilaterals"),
    "generalised": Kind("generalised-plane-strain"),
    "generalised displacement": Kind("generalised-plane-strain", "displacement"),
    "generalised q1p0": Kind("generalised-plane-strain", "q1p0", cells="quadrilaterals"),
    "axisymmetric": Kind("axisymmetric", stabilisation="gls"),
    "axisymmetric displacement": Kind("axisymmetric", "displacement"),
    "axisymmetric q1p0": Kind("axisymmetric", "q1p0", cells="quadrilaterals"),
    "space": Kind("3d"),
    "space displacement": Kind("3d", "displacement"),
    "space q1p0": Kind("3d", "q1p0", cells="quadrilaterals"),
}


def bar(
    kind: Kind, material: Mapping[str, Any], law: str, temperatures: Any, strains: Any,
    *, end: float, steps: int,
) -> dict[str, Any]:  # fmt: skip
    """Return the case.

    Args:
        kind: model, cells and formulation.
        material: mechanical properties.
        law: of the body.
        temperatures: table over time [°C].
        strains: table over time of the elongation over the length.
        end: of the run [s].
        steps: of equal size.
    """
    rod = kind.model == "axisymmetric"
    size = {"length": 0.01, "width": LENGTH} if rod else {"length": LENGTH, "width": 0.01}
    if kind.model == "3d":
        size["depth"] = 0.01
    near, far, *rest = ("bottom", "top") if rod else ("wall", "far", "bottom", "back")
    rest = [] if rod else rest[: 2 if kind.model == "3d" else 1]
    moved = [[time, LENGTH * strain] for time, strain in strains]
    return {
        "geometry": {"generator": "slab", "model": kind.model, "cells": kind.cells,
                     "size": 0.01, **size},
        "materials": {"metal": {"density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0,
                                **material}},
        "bodies": [{"name": "casting", "material": "metal", "law": law,
                    "temperature": temperatures[0][1], "temperature_history": temperatures,
                    "formulation": kind.formulation, "stabilisation": kind.stabilisation}],
        "boundaries": [
            *({"on": f"casting/{s}", "displacement": {"normal": 0.0}} for s in (near, *rest)),
            {"on": f"casting/{far}", "displacement": {"z" if rod else "x": moved}},
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": end, "fixed_step": end / steps},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-11},
    }  # fmt: skip


def stresses(comm: MPI.Intracomm, case: Mapping[str, Any]) -> FloatArray:
    """Run a bar and return the stress along it after each step [Pa]; all others must be zero."""
    found = []
    axis = 1 if case["geometry"]["model"] == "axisymmetric" else 0
    for state in coupled_cases.states(comm, case):
        assert state.counters.cutbacks == 0
        if state.step > 0:
            stress = np.concatenate(comm.allgather(state.cellwise("casting", "stress")))
            along = stress[:, axis].copy()
            stress[:, axis] = 0.0
            np.testing.assert_allclose(along, along[0], rtol=1e-7)
            assert np.abs(stress).max() < 1e-7 * np.abs(along).max()
            found.append(along[0])
    return np.array(found)
