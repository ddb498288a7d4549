"""Laws of parts of an interface: chosen by coordinates, or by a name that the mesh has."""

from __future__ import annotations

import gmsh
import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.case.interfaces import Interface
from castx.domain.mesh import build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.source import gmsh_session
from castx.errors import CaseError
from castx.heat.building import heat_exchange
from castx.transfer.conductance import Faces
from castx.transfer.pair_state import PairState

HEAT = {"law": "constant", "closed": 1000.0, "radiation": {"emissivities": [0.5, 0.5]}}


@pytest.fixture
def mesh(comm, shared_tmp_path):
    """Return two squares that touch at x = 0, above y = 0.5 by a curve with the name "coated"."""
    if comm.rank == 0:
        with gmsh_session():
            add = gmsh.model.geo
            points = [add.addPoint(x, y, 0.0, 0.1)
                      for x, y in ((-1, 0), (0, 0), (1, 0), (1, 1), (0, 1), (-1, 1), (0, 0.5))]
            ends = ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (1, 6), (6, 4))
            lines = [add.addLine(points[a], points[b]) for a, b in ends]
            loops = ((1, 7, 8, 5, 6), (2, 3, 4, -8, -7))
            for name, loop in zip(("mould", "casting"), loops, strict=True):
                curves = [int(np.sign(k)) * lines[abs(k) - 1] for k in loop]
                face = add.addPlaneSurface([add.addCurveLoop(curves)])
                add.addPhysicalGroup(2, [face], name=name)
            add.addPhysicalGroup(1, [lines[7]], name="coated")
            add.addPhysicalGroup(1, [lines[2]], name="far")
            add.synchronize()
            gmsh.model.mesh.generate(2)
            gmsh.write(str(shared_tmp_path / "squares.msh"))
    comm.Barrier()
    geometry = Geometry.model_validate({"file": "squares.msh", "model": "plane-strain"})
    geometry = geometry.model_copy(update={"file": shared_tmp_path / "squares.msh"})
    return build_mesh(geometry, ["casting", "mould"], comm)  # fmt: skip


def exchange(mesh, *patches):
    heat = {**HEAT, "patches": list(patches)} if patches else HEAT
    interface = Interface.read({"bodies": ["casting", "mould"], "heat": heat})
    return heat_exchange(interface, node_pairs(mesh, "casting", "mould"), mesh)


def coefficients(mesh, found) -> tuple[np.ndarray, np.ndarray]:
    """Return the height and the coefficient of all pairs of this rank."""
    count = len(found.pairs.areas)
    faces = Faces.at_temperatures(np.full(count, 500.0), np.full(count, 100.0), 0.0, 0.0)
    state = PairState.of(np.zeros(count), np.zeros(count))
    return found.pairs.points[:, 1], found.law(state, faces).coefficient.value


def test_faces_between_bodies_keep_the_name_of_the_mesh(mesh):
    assert list(mesh.marked) == ["coated"]  # far is an outer surface
    assert mesh.marked["coated"][:, 1].min() == 0.5
    found = exchange(mesh, {"on": "coated", "closed": 200.0})
    y, h = coefficients(mesh, found)
    np.testing.assert_array_equal(h, np.where(y >= 0.5, 200.0, 1000.0))
    assert found.radiation == pytest.approx(1 / 3)


def test_name_and_bounds_together_and_the_first_patch_counts(mesh):
    bare = {"law": "constant", "closed": 50.0, "radiation": {"emissivities": [1, 1]}}
    found = exchange(
        mesh,
        {"on": "coated", "within": {"y": [0.0, 0.75]}, "closed": 200.0},
        {"within": {"y": [0.65, 1.0]}, **bare},
    )
    y, h = coefficients(mesh, found)
    named, above = (y >= 0.5) & (y <= 0.75), y > 0.75
    np.testing.assert_array_equal(h, np.where(named, 200.0, np.where(above, 50.0, 1000.0)))
    assert found.radiation == pytest.approx(np.where(above, 1.0, 1 / 3))


@pytest.mark.parametrize(
    "patch, text",
    [
        ({"on": "coatd"}, "on = 'coatd': no faces between bodies with this name; the mesh names"),
        ({"on": "far"}, "on = 'far': no faces between bodies"),
        ({"within": {"y": [2, 3]}}, r"heat.patches\[0\] holds no node of the interface"),
    ],
)
def test_refused(mesh, patch, text):
    with pytest.raises(CaseError, match=text):
        exchange(mesh, {**patch, "closed": 5.0})
