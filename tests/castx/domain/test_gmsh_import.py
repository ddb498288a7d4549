"""Meshes of other makers: what is read, and what is refused with which words."""

import gmsh
import pytest

from castx.case.geometry import Geometry
from castx.domain import compat
from castx.domain.cell_kinds import KINDS
from castx.domain.mesh import build_mesh
from castx.domain.source import gmsh_session
from castx.domain.summary import mesh_summary
from castx.errors import MeshError

pytestmark = pytest.mark.sampled


def two_boxes(dim=2, names=("casting", "mould"), height=0.0, start=0.0):
    """Two unit squares or cubes side by side, meshed and with named bodies."""
    occ = gmsh.model.occ
    add = occ.addBox if dim == 3 else occ.addRectangle
    size = (1, 1, 1) if dim == 3 else (1, 1)
    boxes = [(dim, add(x, 0, height, *size)) for x in (start, start + 1)]
    occ.fragment(boxes, [])
    occ.synchronize()
    for name, (_, box) in zip(names, gmsh.model.getEntities(dim), strict=False):
        gmsh.model.addPhysicalGroup(dim, [box], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)


def side(x, dim=2):
    """Tags of the entities in the plane of one x."""
    near = gmsh.model.getEntitiesInBoundingBox(x - 1e-3, -1, -1, x + 1e-3, 2, 2, dim - 1)
    return [tag for _, tag in near]


def name_side(x, name, dim=2):
    gmsh.model.addPhysicalGroup(dim - 1, side(x, dim), name=name)


def written(folder, comm, build, mesh=True):
    """A mesh file that rank 0 builds and, unless that is done, meshes."""
    file = folder / "part.msh"
    if comm.rank == 0:
        with gmsh_session():
            build()
            if mesh:
                gmsh.model.mesh.generate(gmsh.model.getDimension())
            gmsh.write(str(file))
    comm.Barrier()
    return file


def read(file, comm, model="plane-strain", bodies=("casting", "mould")):
    return build_mesh(
        Geometry.model_validate({"file": str(file), "model": model}), list(bodies), comm
    )


def transfinite(dim):
    """Make the boxes of quadrilaterals or hexahedra, askew inside."""
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    for curve in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(curve[1], 4, "Progression", 1.2)
    for _, surface in gmsh.model.getEntities(2):
        gmsh.model.mesh.setTransfiniteSurface(surface)
    for _, volume in gmsh.model.getEntities(3) if dim == 3 else ():
        gmsh.model.mesh.setTransfiniteVolume(volume)


@pytest.mark.parametrize("simplicial", [True, False])
@pytest.mark.parametrize("dim, model", [(2, "plane-stress"), (3, "3d")])
def test_any_mesh_with_names_is_read(dim, model, simplicial, comm, shared_tmp_path):
    def build():
        two_boxes(dim)
        name_side(0, "gate", dim)
        name_side(1, "inner", dim)
        if not simplicial:
            transfinite(dim)

    file = written(shared_tmp_path, comm, build)
    mesh = read(file, comm, model)
    assert mesh.bodies["casting"].kind.simplex == simplicial
    casting, mould = mesh_summary(mesh).bodies
    assert casting.volume == pytest.approx(1.0) and mould.volume == pytest.approx(1.0)
    assert casting.surfaces == pytest.approx({"gate": 1.0, "mould": 1.0})
    assert mould.surfaces == pytest.approx({"casting": 1.0})
    assert casting.unnamed == pytest.approx({2: 2.0, 3: 4.0}[dim])


def test_a_name_may_span_several_parts_of_a_body(comm, shared_tmp_path):
    def build():
        two_boxes(names=())
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)], name="both")

    file = written(shared_tmp_path, comm, build)
    (body,) = mesh_summary(read(file, comm, bodies=["both"])).bodies
    assert body.volume == pytest.approx(2.0) and body.unnamed == pytest.approx(6.0)


@pytest.mark.parametrize("recombine", [0, 1])
def test_cells_turned_the_wrong_way_are_turned_back(recombine, comm, shared_tmp_path):
    def build():
        two_boxes()
        gmsh.option.setNumber("Mesh.RecombineAll", recombine)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.reverse([(2, gmsh.model.getEntities(2)[0][1])])

    mesh = read(written(shared_tmp_path, comm, build, mesh=False), comm).parent
    corners = mesh.geometry.x[compat.geometry_nodes(mesh)][:, :, :2]
    assert (KINDS[mesh.topology.cell_name()].corner_volumes(corners) > 0).all()


def second_order():
    two_boxes()
    gmsh.option.setNumber("Mesh.ElementOrder", 2)


def mixed_kinds():
    two_boxes()
    gmsh.model.mesh.setRecombine(2, gmsh.model.getEntities(2)[0][1])


def partly_named():
    two_boxes(names=("casting",))
    gmsh.option.setNumber("Mesh.SaveAll", 1)


def numbered_only():
    two_boxes(names=("casting",))
    gmsh.model.addPhysicalGroup(2, [gmsh.model.getEntities(2)[1][1]], 9)


def doubly_named():
    two_boxes()
    gmsh.model.addPhysicalGroup(2, [gmsh.model.getEntities(2)[0][1]], name="third")


def surface_like_a_body():
    two_boxes()
    name_side(0, "mould")


def side_with_two_names():
    two_boxes()
    name_side(0, "gate")
    name_side(0, "wall")


def nameless():
    two_boxes(names=())
    gmsh.option.setNumber("Mesh.SaveAll", 1)


@pytest.mark.parametrize(
    "build, model, bodies, text",
    [
        (two_boxes, "plane-strain", ["casting", "die"], "no body 'die'; it has: casting, mould"),
        (two_boxes, "plane-strain", ["casting", "mold"], 'did you mean "mould"'),
        (two_boxes, "plane-strain", ["casting"], r"not list under \[\[bodies\]\]: mould"),
        (two_boxes, "3d", ["casting", "mould"], "model is 3-D but .*part.msh is a 2-D mesh"),
        (lambda: two_boxes(3), "plane-strain", ["casting", "mould"], "is 2-D but .* a 3-D mesh"),
        (nameless, "plane-strain", ["casting", "mould"], "has no named physical surfaces; name"),
        (
            second_order,
            "plane-strain",
            ["casting", "mould"],
            "must be only of linear triangles or only of linear quadrilaterals",
        ),
        (mixed_kinds, "plane-strain", ["casting", "mould"], "kinds Triangle 3, Quadrilateral 4;"),
        (partly_named, "plane-strain", ["casting"], "elements belong to no named body; give every"),
        (numbered_only, "plane-strain", ["casting"], "without a name: dimension 2, number 9"),
        (
            doubly_named,
            "plane-strain",
            ["casting", "mould", "third"],
            "'casting' and 'third' overlap; a part has one name",
        ),
        (
            surface_like_a_body,
            "plane-strain",
            ["casting", "mould"],
            "surface with the name of a body: 'mould'; rename the surface",
        ),
        (
            side_with_two_names,
            "plane-strain",
            ["casting", "mould"],
            "'gate' and 'wall' overlap; a part has one name",
        ),
        (
            lambda: two_boxes(height=0.5),
            "plane-strain",
            ["casting", "mould"],
            "leaves the plane z = 0 by 0.5 m",
        ),
        (
            lambda: two_boxes(start=-0.5),
            "axisymmetric",
            ["casting", "mould"],
            "lies in r >= 0, but .*part.msh reaches r = -0.5 m",
        ),
    ],
)
def test_meshes_that_do_not_fit_are_refused(build, model, bodies, text, comm, shared_tmp_path):
    file = written(shared_tmp_path, comm, build)
    with pytest.raises(MeshError, match=text):
        read(file, comm, model, bodies)


def polygons(points, cells):
    """A discrete model from points and, for each body, triangles or quadrilaterals."""
    for tag, (name, corners) in enumerate(cells.items(), start=1):
        gmsh.model.addDiscreteEntity(2, tag)
        if tag == 1:
            flat = [float(v) for point in points for v in (*point, 0.0)]
            gmsh.model.mesh.addNodes(2, tag, range(1, len(points) + 1), flat)
        kind = len(corners[0]) - 1 if corners else 2
        gmsh.model.mesh.addElementsByType(tag, kind, [], [n + 1 for c in corners for n in c])
        gmsh.model.addPhysicalGroup(2, [tag], tag, name=name)


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (2, 0), (2, 1), (1.5, 0.9)]


@pytest.mark.parametrize(
    "cells, text",
    [
        (
            {"casting": [(0, 1, 2), (0, 4, 1)], "mould": [(0, 2, 3)]},
            r"1 elements have no volume, the first at \(0.5, 0\) m",
        ),
        (
            {"casting": [(0, 1, 2), (0, 2, 3)], "mould": [(0, 2, 4)]},
            "more than two elements share a face; the parts overlap",
        ),
        (
            {"casting": [(0, 1, 2, 3)], "mould": [(1, 5, 7, 6)]},
            r"1 elements are flat or not convex, the first at \(1.625, 0.475\) m",
        ),
        (
            {"casting": [(0, 1, 2, 3)], "mould": [(1, 5, 2, 6)]},
            r"1 elements are flat or not convex, the first at \(1.5, 0.5\) m",
        ),
        ({"casting": [(0, 1, 2)], "mould": []}, "the body 'mould' has no elements|no body 'mould'"),
    ],
)
def test_broken_meshes_are_refused(cells, text, comm, shared_tmp_path):
    file = written(shared_tmp_path, comm, lambda: polygons(SQUARE, cells), mesh=False)
    with pytest.raises(MeshError, match=text):
        read(file, comm)


def test_a_missing_file_is_named(comm, shared_tmp_path):
    with pytest.raises(MeshError, match=r"there is no mesh file .*nowhere\.msh"):
        read(shared_tmp_path / "nowhere.msh", comm)


@pytest.mark.parametrize("content", ["", "no mesh at all\n", "$MeshFormat\n4.1 0 8\n$EndMesh"])
def test_a_file_that_is_no_mesh_is_refused(content, comm, shared_tmp_path):
    file = shared_tmp_path / "broken.msh"
    if comm.rank == 0:
        file.write_text(content)
    comm.Barrier()
    with pytest.raises(MeshError, match=r"broken\.msh"):
        read(file, comm)


def test_gmsh_is_left_as_it_was():
    assert not gmsh.isInitialized()
    gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("mine")
        with gmsh_session():
            assert gmsh.model.getCurrent() == "castx"
        assert gmsh.model.getCurrent() == "mine"
    finally:
        gmsh.finalize()
