"""Strain in the brittle range of a block that is stretched evenly while it is cooled from one side.

All that moves is given: elongation at 1e-3/s, so that every node gains the rate times the time that
it is in the range, at the tolerances of the program. Temperatures differ by 0.01 K, or by 7 K where
the block conducts as an alloy does, and hardly at the insulated surface across from the cooled one.
There the gradient of a single triangle points anywhere.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.foundry.hot_tearing import BRIDGED
from castx.foundry.stress.cracks import cracks_of
from castx.process.simulation import Simulation

pytestmark = pytest.mark.sampled

RATE, END, LENGTH, HEIGHT, SIZE = 1e-3, 40.0, 0.02, 0.01, 2e-3
ALLOY = {
    "law": "perzyna", "young_modulus": 5e9, "poisson_ratio": 0.3, "expansion": 0.0,
    "yield_stress": 1e6, "viscosity": 1e8, "density": 1000.0, "heat_capacity": 1000.0,
    "solidus": 550, "liquidus": 600, "latent_heat": 1e5,
    "liquid": {"viscosity": 1e6, "coherency": 0.7},
}  # fmt: skip
MESHES = {
    "triangles": {"model": "plane-strain", "cells": "simplices"},
    "quadrilaterals": {"model": "plane-strain", "cells": "quadrilaterals"},
    "tetrahedra": {"model": "3d", "cells": "simplices", "depth": HEIGHT},
}


def stretched_block(name, conductivity):
    back = {"on": "casting/back", "displacement": {"z": 0.0}}
    pulled = [[0.0, 0.0], [END, RATE * LENGTH * END]]
    cooled = {"type": "convection", "coefficient": 200, "ambient": 100}
    content = {
        "geometry": {"generator": "slab", "length": LENGTH, "width": HEIGHT, "size": SIZE,
                     **MESHES[name]},
        "materials": {"alloy": {**ALLOY, "conductivity": conductivity}},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": 605,
                    "law": "thermo-elasto-viscoplastic"}],
        "boundaries": [
            {"on": "casting/wall", "displacement": {"x": 0.0}},
            {"on": "casting/far", "displacement": {"x": pulled}},
            {"on": "casting/bottom", "displacement": {"y": 0.0}},
            {"on": "casting/top", "heat": cooled},
            *([back] if name == "tetrahedra" else []),
        ],
        "time": {"end": END},
        "output": {"fields": ["brittle_strain", "brittle_time"]},
    }  # fmt: skip
    return read_case(content, Path("block.toml"))


@pytest.mark.ranks
@pytest.mark.parametrize("conductivity", [1e5, 150.0])
@pytest.mark.parametrize("name", MESHES)
def test_every_node_of_an_evenly_stretched_block_gains_the_same(comm, name, conductivity):
    case = stretched_block(name, conductivity)
    simulation = Simulation.from_case(case, comm)
    cracks = cracks_of(case, simulation.mesh)
    for state in simulation:
        cracks.update(state)
    strains = cracks.strains("casting")
    assert strains is not None
    exact = RATE * strains.duration(BRIDGED)
    found = strains.largest(BRIDGED)
    simulation.destroy()
    assert np.isfinite(exact).all()
    np.testing.assert_allclose(found, exact, rtol=0.01)
