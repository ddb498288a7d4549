"""Two castings freeze side by side in one mould, each on its own floor.

Reference: the weight of each, symmetry, and that the mould takes up what both have lost.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.materials.flow import VISCOPLASTIC
from castx.materials.lookup import find_material
from castx.meshes.grading import uniform
from castx.meshes.linear_mesh import mirrored
from castx.meshes.model import fill_model, plane
from castx.meshes.structured import grid
from tests.coupled_cases import paired
from tests.defaults.runs import bears, by_default, complies

WIDTH, HEIGHT, WALL, SIZE = 0.02, 0.015, 0.01, 0.005
WEIGHT = find_material("AlSi7Mg").density * 9.81 * WIDTH * HEIGHT
CASTINGS = ("left", "right")


def draw() -> None:
    """Draw two boxes, open at the top, with half a wall on either side of the middle."""
    x = uniform(0.5 * WALL + WIDTH + WALL, SIZE)
    y = uniform(WALL + HEIGHT, SIZE) - WALL

    def body(middle):
        inside = (middle[:, 0] > 0.5 * WALL) & (middle[:, 0] < 0.5 * WALL + WIDTH)
        return np.where(inside & (middle[:, 1] > 0.0), 1, 2)

    mesh = mirrored(grid(x, y, body), 0)
    middle = mesh.points[mesh.cells].mean(axis=1)
    left = (mesh.regions == 1) & (middle[:, 0] < 0.0)
    mesh = replace(mesh, regions=np.where(left, 0, mesh.regions))
    fill_model(mesh, [*CASTINGS, "mould"], [plane("base", 1, -WALL, 1e-9)])


def case(comm, folder: Path) -> dict:
    """Return the case; nothing but its own floor and walls holds a casting."""
    file = folder / "two.msh"
    if comm.rank == 0:
        with gmsh_session():
            draw()
            gmsh.write(str(file))
    comm.Barrier()
    heat = {"law": "limited", "closed": 2000, "gas_conductivity": 0.05}
    return {
        "geometry": {"file": str(file), "model": "plane-strain"},
        "bodies": [
            *({"name": name, "material": "AlSi7Mg", "temperature": 650, "law": VISCOPLASTIC}
              for name in CASTINGS),
            {"name": "mould", "material": "steel-H13", "temperature": 200},
        ],
        "interfaces": [{"bodies": [name, "mould"], "heat": heat} for name in CASTINGS],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0}}],
        "loads": {"gravity": [0, -9.81, 0]},
        "time": {"end": 22},
    }  # fmt: skip


def test_two_castings_in_one_mould(comm, shared_tmp_path):
    for state in by_default(comm, case(comm, shared_tmp_path)):
        complies(state, WEIGHT)
        totals = state.totals
        for name in CASTINGS:
            bears(state, f"{name}/mould", WEIGHT)
        gained = sum(totals[f"{name}.heat_in"] for name in (*CASTINGS, "mould"))
        assert abs(gained) < 1e-5 * totals["mould.heat_in"]
        for name in ("gap", "heat_transfer_coefficient"):
            left, right = (np.sort(paired(state, f"{one}/mould", name)) for one in CASTINGS)
            np.testing.assert_allclose(left, right, rtol=1e-3, atol=1e-9)
        fractions = [totals[f"{name}.solid_fraction"] for name in CASTINGS]
        assert fractions[0] == pytest.approx(fractions[1], rel=1e-4)
    assert fractions[0] > 0.9 and totals["left/mould.max_gap"] > 1e-6
