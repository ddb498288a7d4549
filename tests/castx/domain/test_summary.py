"""Sizes of a mesh, the same on any number of ranks."""

from dataclasses import replace
from math import pi

from mpi4py import MPI

import gmsh
import numpy as np
import pytest

from castx.domain.summary import mesh_summary
from tests.elastic_bodies import drawn, generated

R, H, WALL, FLOOR = 0.03, 0.1, 0.025, 0.02
NAMES = ("casting", "mould")


def cylinder(comm, model="3d", **arguments):
    sector = {"sector": "quarter"} if model == "3d" else {}
    return generated(
        comm, model, "cylinder_in_mould", NAMES, radius=R, height=H, wall=WALL, floor=FLOOR,
        size=0.01, **sector, **arguments,
    )  # fmt: skip


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_extent_and_interfaces(cells, comm):
    summary = mesh_summary(cylinder(comm, cells=cells))
    assert summary.lowest == pytest.approx((0.0, 0.0, -FLOOR))
    assert summary.highest == pytest.approx((R + WALL, R + WALL, H))
    (interface,) = summary.interfaces
    assert interface.bodies == NAMES
    assert interface.area == summary.bodies[0].surfaces["mould"]
    (alone,) = mesh_summary(cylinder(MPI.COMM_SELF, cells=cells)).interfaces
    assert interface.nodes == alone.nodes > 0
    assert interface.area == pytest.approx(alone.area, rel=1e-12)


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_sizes_of_an_axisymmetric_body_are_those_of_the_full_turn(cells, comm):
    casting, mould = mesh_summary(cylinder(comm, "axisymmetric", cells=cells)).bodies
    assert casting.volume == pytest.approx(pi * R**2 * H, rel=1e-12)
    around = pi * ((R + WALL) ** 2 * (H + FLOOR) - R**2 * H)
    assert mould.volume == pytest.approx(around, rel=1e-12)
    assert casting.surfaces["top"] == pytest.approx(pi * R**2, rel=1e-12)
    assert mould.surfaces["outside"] == pytest.approx(2 * pi * (R + WALL) * (H + FLOOR), rel=1e-12)
    body = cylinder(comm, "axisymmetric", cells=cells).bodies["casting"]
    owned = body.nodes.dofmap.index_map.size_local
    assert casting.nodes == comm.allreduce(owned)


def draw_square() -> None:
    square = gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [square], name="plate")
    gmsh.model.addPhysicalGroup(1, [1], name="bottom")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
    gmsh.model.mesh.generate(2)


@pytest.mark.ranks
def test_faces_without_a_name_are_counted(comm, shared_tmp_path):
    mesh = drawn(comm, "plane-strain", ["plate"], shared_tmp_path / "plate.msh", draw_square)
    summary = mesh_summary(mesh)
    (plate,) = summary.bodies
    assert plate.surfaces == pytest.approx({"bottom": 2.0})
    assert plate.unnamed == pytest.approx(4.0) and plate.volume == pytest.approx(2.0)
    assert summary.interfaces == ()
    cells = mesh.parent.topology.index_map(2)
    assert plate.cells == comm.allreduce(cells.size_local)
    assert np.isfinite(summary.lowest).all()


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_heights_are_those_of_the_cells_at_the_interface(model, cells, comm):
    sides = [0.06, 0.04, 0.04][: 3 if model == "3d" else 2]
    mesh = generated(
        comm, model, "box_in_mould", NAMES, box=sides, wall=0.02, size=0.01, cells=cells
    )
    casting, mould = mesh_summary(mesh).bodies
    assert casting.heights == {"mould": pytest.approx(0.01, rel=0.05)}
    assert mould.heights == {"casting": pytest.approx(0.01, rel=0.05)}


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_heights_follow_the_size_at_the_interface(cells, comm):
    casting = mesh_summary(
        cylinder(comm, "axisymmetric", cells=cells, interface_size=0.004)
    ).bodies[0]
    assert casting.heights["mould"] == pytest.approx(0.004, rel=0.2)


def test_a_modulus_leaves_planes_of_symmetry_out(comm):
    casting = mesh_summary(cylinder(comm, "3d", cells="quadrilaterals")).bodies[0]
    assert casting.modulus == pytest.approx(R * H / (2 * (R + H)), rel=0.02)
    cut = replace(casting, surfaces={**casting.surfaces, "symmetry-z": 1.0})
    assert cut.modulus == casting.modulus
