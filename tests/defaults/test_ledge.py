"""Metal under and over ledges at default settings: no gap where the skin is liquid, one behind it.

Reference: which cells at the wall are coherent, found from the solid fractions of their corners.
"""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.materials.lookup import find_material
from tests.coupled_cases import states

pytestmark = pytest.mark.sampled

STEM, FLANGE, HEIGHT, WALL = 0.015, 0.030, 0.015, 0.012
ALLOY = "AlSi7Mg"
BELOW, ABOVE = "stem below a flange", "foot below an overhang"


def draw(shape: str) -> None:
    """Draw half of a casting with a step of 15 mm, and the mould around it but for its top."""
    occ, down = gmsh.model.occ, -HEIGHT - WALL
    widths = (STEM, FLANGE) if shape == BELOW else (FLANGE, STEM)
    parts = [
        (2, occ.addRectangle(0, z, 0, width, HEIGHT))
        for width, z in zip(widths, (-HEIGHT, 0.0), strict=True)
    ]
    casting = occ.fuse(parts[:1], parts[1:])[0]
    block = occ.addRectangle(0, down, 0, FLANGE + WALL, 2 * HEIGHT + WALL)
    mould = occ.cut([(2, block)], casting, removeTool=False)[0]
    occ.fragment(casting, mould)
    occ.synchronize()
    bodies = {"casting": casting, "mould": mould}
    for name, entities in bodies.items():
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in entities], name=name)
    for line in gmsh.model.getEntities(1):
        _, y, _, right, top, _ = gmsh.model.getBoundingBox(*line)
        owner = "casting" if y > -HEIGHT - 1e-5 else "mould"
        if right < 1e-6:
            gmsh.model.addPhysicalGroup(1, [line[1]], name=f"{owner} middle")
        elif top < down + 1e-6:
            gmsh.model.addPhysicalGroup(1, [line[1]], name="base")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.004)
    gmsh.model.mesh.generate(2)


def case(comm, folder: Path, shape: str, gravity: bool, **contact) -> dict:
    """Return an AlSi7Mg casting in a steel mould, both with the data and settings of castx."""
    file = folder / "ledge.msh"
    if comm.rank == 0:
        with gmsh_session():
            draw(shape)
            gmsh.write(str(file))
    comm.Barrier()
    return {
        "geometry": {"file": str(file), "model": "plane-strain"},
        "bodies": [
            {"name": "casting", "material": ALLOY, "temperature": 640,
             "law": "thermo-elasto-viscoplastic"},
            {"name": "mould", "material": "steel-H13", "temperature": 150},
        ],
        "interfaces": [
            {"bodies": contact.pop("bodies", ["casting", "mould"]), "contact": contact,
             "heat": {"law": "limited", "closed": 3000, "gas_conductivity": 0.05}},
        ],
        "boundaries": [
            {"on": "casting/casting middle", "displacement": {"normal": 0}},
            {"on": "mould/mould middle", "displacement": {"normal": 0}},
            {"on": "mould/base", "displacement": {"normal": 0}},
        ],
        "loads": {"gravity": [0, -9.81 if gravity else 0.0, 0]},
        "time": {"end": 6},
    }  # fmt: skip


def liquid_skin(comm, state, points: np.ndarray) -> np.ndarray:
    """Return which places have no metal of the casting that bears."""
    mesh = state.mesh.bodies["casting"]
    liquid = find_material(ALLOY, {}).liquid
    assert liquid is not None
    solid = state.nodal("casting", "solid_fraction") > liquid.coherency
    skin = comm.allgather(np.round(mesh.points[solid], 8).reshape(-1, 2))
    coherent = {tuple(p) for p in np.concatenate(skin)}
    return np.array([tuple(p) not in coherent for p in np.round(points, 8)], dtype=bool)


def check(comm, data: dict, column: float) -> tuple[float, float]:
    """Check all states; return the largest gap while all is liquid at the wall, and at the end."""
    name = "/".join(data["interfaces"][0]["bodies"])
    early = late = 0.0
    for state in states(comm, data):
        if state.step == 0:
            continue
        points, gap = state.pairs[name].points, state.paired(name, "gap")
        liquid = liquid_skin(comm, state, points)
        assert np.all(gap[liquid] < 1e-12)
        pressure = state.paired(name, "contact_pressure")[liquid]
        assert np.all(pressure >= 0.999 * column * (HEIGHT - points[:, 1])[liquid] - 1e-6)
        late = comm.allreduce(float(gap.max(initial=0.0)), op=MPI.MAX)
        if comm.allreduce(int(np.count_nonzero(~liquid))) == 0:
            early = late
    return early, late


@pytest.mark.parametrize("gravity", [True, False])
@pytest.mark.parametrize("shape", [BELOW, ABOVE])
def test_the_gap_opens_behind_a_coherent_skin(comm, shared_tmp_path, shape, gravity):
    data = case(comm, shared_tmp_path, shape, gravity)
    weight = find_material(ALLOY, {}).density * 9.81 if gravity else 0.0
    early, late = check(comm, data, weight)
    assert early < 1e-12
    assert late > 2e-6


def test_with_the_mould_named_first(comm, shared_tmp_path):
    """The same wall, told from the other side."""
    data = case(comm, shared_tmp_path, ABOVE, True, bodies=["mould", "casting"])
    early, late = check(comm, data, find_material(ALLOY, {}).density * 9.81)
    assert early < 1e-12
    assert late > 2e-6
