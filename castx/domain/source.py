"""The gmsh mesh of a geometry, generated, read from a file or made of CAD files, on one rank."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import gmsh
import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.case.cad.geometry import CadGeometry
from castx.case.geometry import GENERATORS, Geometry
from castx.domain import compat
from castx.domain.cad.description import part_of
from castx.domain.cad.guarded import meshed_apart
from castx.domain.cell_kinds import KINDS
from castx.domain.gmsh_import import NamedMesh, read_model
from castx.errors import MeshError
from castx.input.problems import among
from castx.meshes.cad.report import Report

OF_MESHIO = {
    "interval": "line", "triangle": "triangle", "quadrilateral": "quad", "tetrahedron": "tetra",
    "hexahedron": "hexahedron",
}  # fmt: skip
"""meshio's names of DOLFINx's cells."""
Move = Callable[[FloatArray, list[LongArray]], FloatArray]

MESH_BEGINNINGS = (b"$MeshFormat", b"$Comments")


@contextmanager
def gmsh_session() -> Iterator[None]:
    """Open a silent gmsh with an empty model, and restore the earlier model afterwards."""
    started = not gmsh.isInitialized()
    if started:
        with compat.kept_signals():
            gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
    previous = gmsh.model.getCurrent()
    gmsh.model.add("castx")
    try:
        yield
    finally:
        gmsh.model.remove()
        if started:
            with compat.kept_signals():
                gmsh.finalize()
        else:
            gmsh.model.setCurrent(previous)


def source_of(geometry: Geometry) -> str:
    """Return the origin of a mesh, for messages."""
    if geometry.file is not None:
        return str(geometry.file)
    if geometry.cad is not None:
        return ", ".join(str(path) for path, _ in geometry.cad.sources)
    return f"generator {geometry.generator}"


def named_mesh(geometry: Geometry, body_names: Sequence[str]) -> NamedMesh:
    """Return the mesh of a geometry, checked against the case.

    Args:
        geometry: to be meshed.
        body_names: names of the bodies of the case, in their order.

    Raises:
        MeshError: gmsh fails, or names, elements or dimension do not fit.
    """
    source = source_of(geometry)
    with gmsh_session():
        report = _fill(geometry, body_names)
        mesh = replace(read_model(body_names, geometry.gdim, source), report=report)
    inmost = mesh.points[:, 0].min()
    if geometry.model == "axisymmetric" and inmost < -1e-9 * np.ptp(mesh.points[:, 0]):
        raise MeshError(
            f"an axisymmetric mesh lies in r >= 0, but {source} reaches r = {inmost:g} m; move it, "
            "or choose another geometry.model"
        )
    return mesh


def write_mesh(geometry: Geometry, file: Path, body_names: Sequence[str] | None = None) -> None:
    """Write the mesh of a geometry, as gmsh or as meshio does; call it on one rank only.

    gmsh writes .msh files; all others hold the cells with the number of their body and the named
    faces with that of their surface, and sets of their names where the format has them.

    Args:
        geometry: to be meshed.
        file: to write; its end says the format.
        body_names: names of the bodies of the case; None: those that CAD files have.

    Raises:
        MeshError: the mesh cannot be made or the file not be written.
    """
    if file.suffix.lower() != ".msh":
        names = tuple(body_names or ())
        _write_other(named_mesh(geometry, names), names, file)
        return
    with gmsh_session():
        _fill(geometry, body_names)
        try:
            gmsh.write(str(file))
        except Exception as error:  # gmsh raises nothing more special
            raise MeshError(f"gmsh cannot write {file}: {error}") from error


def _write_other(mesh: NamedMesh, body_names: Sequence[str], file: Path) -> None:
    """Write a mesh in a format of meshio."""
    import meshio  # a tenth of a second that no run should wait for

    known = sorted(meshio.extension_to_filetypes)
    if file.suffix.lower() not in known:
        raise MeshError(f"cannot write {file}: {among(file.suffix, known, what='formats')}")
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    kinds = [mesh.kind, KINDS[mesh.kind.face]]
    groups = [(mesh.cells, mesh.bodies), (mesh.faces, mesh.face_surfaces)]
    blocks = [
        (OF_MESHIO[kind.name], corners[:, np.argsort(kind.from_gmsh)])
        for kind, (corners, _) in zip(kinds, groups, strict=True)
    ]
    nowhere = [np.full(len(numbers), -1) for _, numbers in groups]
    (_, bodies), (_, surfaces) = groups
    empty = np.empty(0, dtype=np.int64)
    sets = {name: [np.flatnonzero(bodies == i), empty] for i, name in enumerate(body_names)}
    sets |= {
        name: [empty, np.flatnonzero(surfaces == i)] for i, name in enumerate(mesh.surface_names)
    }
    data = {"body": [bodies, nowhere[1]], "surface": [nowhere[0], surfaces]}
    try:
        keeps_sets = file.suffix.lower() == ".inp"
        written = meshio.Mesh(points, blocks, cell_data={} if keeps_sets else data,
                              cell_sets=sets if keeps_sets else None)  # fmt: skip
        meshio.write(file, written)
    except (Exception, SystemExit) as error:  # meshio raises whatever it meets, and exits
        raise MeshError(f"meshio cannot write {file}: {type(error).__name__}: {error}") from error


def _fill(geometry: Geometry, body_names: Sequence[str] | None) -> Report | None:
    """Fill the current gmsh model, and return the report of CAD files."""
    if geometry.cad is not None:
        return _mesh_cad(geometry.cad, body_names)
    if geometry.file is not None:
        _open(geometry.file)
    else:
        _generate(geometry)
    return None


def _mesh_cad(cad: CadGeometry, body_names: Sequence[str] | None) -> Report:
    with TemporaryDirectory() as folder:
        mesh = Path(folder) / "mesh.msh"
        report = meshed_apart(part_of(cad, body_names), mesh)
        _open(mesh)
    return report


def _open(file: Path) -> None:
    """Read a mesh file without running anything in it.

    gmsh takes a file that does not begin like a mesh for a script and runs it, and reads options
    beside the file that may run commands as well; so it gets a copy in a folder of its own.
    """
    if not file.is_file():
        raise MeshError(f"there is no mesh file {file}")
    try:
        content = file.read_bytes()
    except OSError as error:
        raise MeshError(f"cannot read the mesh file {file}: {error.strerror}") from None
    if not content.startswith(MESH_BEGINNINGS):
        raise MeshError(
            f"{file} is not a gmsh mesh: it must begin with $MeshFormat; "
            "export it from gmsh as .msh, version 2 or 4"
        )
    with TemporaryDirectory() as folder:
        copy = Path(folder) / "mesh.msh"
        copy.write_bytes(content)
        try:
            gmsh.merge(str(copy))
        except Exception as error:  # gmsh raises nothing more special
            raise MeshError(f"gmsh cannot read {file}: {error}") from error


def _generate(geometry: Geometry) -> None:
    name = str(geometry.generator)
    if name not in GENERATORS:
        raise MeshError(f"there is no generator {name!r}; {among(name, list(GENERATORS))}")
    generator = GENERATORS[name].mesh
    arguments = {"model": geometry.model, **geometry.arguments}
    try:
        inspect.signature(generator).bind(**arguments)
    except TypeError as error:
        known = [argument for argument in inspect.signature(generator).parameters]
        raise MeshError(f"generator {name}: {error}; its arguments: {', '.join(known)}") from None
    try:
        generator(**arguments)
    except ValueError as error:
        raise MeshError(f"generator {name}: {error}") from error


def write_moved(file: Path, target: Path, move: Move) -> None:
    """Write a gmsh mesh anew with other places of its nodes; call it on one rank only.

    Names of bodies and surfaces stay.

    Args:
        file: the mesh.
        target: to write, .msh.
        move: takes the places of the nodes (nodes, 3) and the nodes of the cells of the highest
            dimension by kind, (cells, corners), and returns the new places.

    Raises:
        MeshError: a mesh cannot be read or written.
    """
    if target.suffix.lower() != ".msh":
        raise MeshError(f"a moved mesh is written as .msh, and {target} is none")
    with gmsh_session():
        _open(file)
        tags, places, _ = gmsh.model.mesh.getNodes()
        order = np.argsort(tags)
        tags, places = tags[order], places.reshape(-1, 3)[order]
        kinds, _, corners = gmsh.model.mesh.getElements(dim=gmsh.model.getDimension())
        cells = [
            np.searchsorted(tags, found).reshape(
                -1, gmsh.model.mesh.getElementProperties(kind)[3]
            )
            for kind, found in zip(kinds, corners, strict=True)
        ]
        for tag, place in zip(tags, move(places, cells), strict=True):
            gmsh.model.mesh.setNode(int(tag), place.tolist(), [])
        try:
            gmsh.write(str(target))
        except Exception as error:  # gmsh raises nothing more special
            raise MeshError(f"gmsh cannot write {target}: {error}") from error
