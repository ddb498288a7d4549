"""An assembly of named solids: volumes, contacts, STEP, mesh; lengths in mm."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import gmsh
import numpy as np
import numpy.typing as npt

from demos.parts.solids import Point, quiet, within
from demos.parts.step_names import with_names

MM = 1e-3
GRACE = 1e-6
"""Share of an assembly's volume by which solids may overlap through rounding."""


Box = tuple[Point, Point]
"""Lowest and highest corner."""


@dataclass(frozen=True)
class Assembly:
    """Named solids of the current gmsh model that touch each other but do not overlap.

    Attributes:
        name: of the assembly.
        solids: tags of the volumes by the names of the bodies.
        surfaces: boxes round free faces that have a name, the first that fits; the faces of
            several bodies may have the same one, and all others are called `outside`.
        coarse: bodies whose mesh may grow towards the outside.
        apart: how far a body is moved in an exploded view, in mm.
    """

    name: str
    solids: Mapping[str, int]
    surfaces: Mapping[str, tuple[Box, ...]]
    coarse: frozenset[str] = frozenset()
    apart: Mapping[str, Point] = field(default_factory=dict)


def volumes(assembly: Assembly) -> dict[str, float]:
    """Return the volumes of the solids [mm³]."""
    return {name: gmsh.model.occ.getMass(3, tag) for name, tag in assembly.solids.items()}


def joined(assembly: Assembly) -> Assembly:
    """Return the assembly with one face wherever two solids touch.

    Raises:
        ValueError: solids overlap.
    """
    if len(assembly.solids) == 1:
        gmsh.model.occ.synchronize()
        return assembly
    before = volumes(assembly)
    given = [(3, tag) for tag in assembly.solids.values()]
    _, pieces = gmsh.model.occ.fragment(given[:1], given[1:])
    gmsh.model.occ.synchronize()
    for name, found in zip(assembly.solids, pieces, strict=True):
        if len(found) != 1:
            raise ValueError(f"{name} overlaps another solid: it falls into {len(found)} pieces")
    solids = {n: found[0][1] for n, found in zip(assembly.solids, pieces, strict=True)}
    after = sum(gmsh.model.occ.getMass(3, tag) for tag in solids.values())
    if abs(after - sum(before.values())) > GRACE * after:
        raise ValueError("the volumes of the solids change as they are joined")
    return Assembly(assembly.name, solids, assembly.surfaces, assembly.coarse, assembly.apart)


def faces_by_bodies(assembly: Assembly) -> dict[tuple[str, ...], list[int]]:
    """Return the faces of a joined assembly by the one or two bodies that they bound."""
    names = {tag: name for name, tag in assembly.solids.items()}
    places = {name: place for place, name in enumerate(assembly.solids)}
    found: dict[tuple[str, ...], list[int]] = {}
    for _, tag in gmsh.model.getEntities(2):
        bodies = {names[volume] for volume in gmsh.model.getAdjacencies(2, tag)[0]}
        if bodies:
            found.setdefault(tuple(sorted(bodies, key=places.__getitem__)), []).append(tag)
    return found


def contacts(assembly: Assembly) -> dict[tuple[str, str], float]:
    """Return the areas at which solids of a joined assembly touch [mm²]."""
    return {
        (bodies[0], bodies[1]): sum(gmsh.model.occ.getMass(2, tag) for tag in tags)
        for bodies, tags in faces_by_bodies(assembly).items()
        if len(bodies) == 2
    }


def free_surfaces(assembly: Assembly) -> dict[str, list[int]]:
    """Return the tags of the free faces of a joined assembly by their names.

    Raises:
        ValueError: a name selects nothing.
    """
    found: dict[str, list[int]] = {name: [] for name in assembly.surfaces}
    for bodies, tags in faces_by_bodies(assembly).items():
        if len(bodies) == 1:
            for tag in tags:
                found.setdefault(surface_name(assembly, tag), []).append(tag)
    empty = [name for name, tags in found.items() if not tags]
    if empty:
        raise ValueError(f"no free face of the {assembly.name} is {empty[0]!r}")
    return found


def surface_name(assembly: Assembly, face: int) -> str:
    """Return the name of a free face."""
    bounds = gmsh.model.getBoundingBox(2, face)
    for name, boxes in assembly.surfaces.items():
        if any(within(bounds, *box) for box in boxes):
            return name
    return "outside"


def write_step(assembly: Assembly, file: Path) -> None:
    """Write all solids as one STEP assembly, each with its name; call it before `joined`."""
    occ = gmsh.model.occ
    others = [tag for tag in occ.getEntities(3) if tag[1] not in assembly.solids.values()]
    occ.remove(others, recursive=True)
    occ.remove([entity for d in (2, 1, 0) for entity in occ.getEntities(d)], recursive=False)
    occ.synchronize()
    with TemporaryDirectory() as folder:
        unnamed = Path(folder) / "unnamed.step"
        with quiet():
            gmsh.write(str(unnamed))
        text = unnamed.read_text(encoding="ascii")
        order = _order_of(unnamed, assembly)
    file.write_text(with_names(text, order, assembly.name), encoding="ascii")


def _order_of(step: Path, assembly: Assembly) -> list[str]:
    """Return the names of the solids in the order of a STEP file, by volume and centre."""
    here = gmsh.model.getCurrent()
    known = {name: _measures(tag) for name, tag in assembly.solids.items()}
    gmsh.model.add("written")
    found = [_measures(tag) for _, tag in gmsh.model.occ.importShapes(str(step))]
    gmsh.model.remove()
    gmsh.model.setCurrent(here)
    names = list(known)
    away = np.array([[np.abs(known[name] - one).max() for name in names] for one in found])
    places = away.argmin(axis=1)
    if sorted(places) != list(range(len(names))) or away.min(axis=1).max() > 1e-3:
        raise ValueError("the STEP file does not hold the solids that were drawn")
    return [names[place] for place in places]


def _measures(solid: int) -> npt.NDArray[np.float64]:
    """Return the edge of a cube of the same volume, and the centre of mass."""
    volume = gmsh.model.occ.getMass(3, solid)
    return np.array([np.cbrt(volume), *gmsh.model.occ.getCenterOfMass(3, solid)])


def fill_mesh(assembly: Assembly, size: float, growth: float = 3.0) -> None:
    """Mesh a joined assembly by tetrahedra with names, in metres.

    Args:
        assembly: to be meshed.
        size: of the cells of all bodies and faces but the outside of coarse ones.
        growth: size there, in sizes.
    """
    for name, tag in assembly.solids.items():
        gmsh.model.addPhysicalGroup(3, [tag], name=name)
    for name, tags in free_surfaces(assembly).items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    fine = {t for name, t in assembly.solids.items() if name not in assembly.coarse}
    for dimension, tag in gmsh.model.getEntities(0):
        edges = gmsh.model.getAdjacencies(0, tag)[0]
        faces = {f for edge in edges for f in gmsh.model.getAdjacencies(1, edge)[0]}
        around = {v for face in faces for v in gmsh.model.getAdjacencies(2, face)[0]}
        local = size if around & fine else growth * size
        gmsh.model.mesh.setSize([(dimension, tag)], local)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 8)
    gmsh.option.setNumber("Mesh.MeshSizeMin", min(0.4 * size, 5.0))
    gmsh.option.setNumber("Mesh.Algorithm", 5)
    gmsh.option.setNumber("Mesh.MeshSizeMax", growth * size)
    gmsh.option.setNumber("Mesh.ScalingFactor", MM)
    gmsh.model.mesh.generate(3)
    for method in ("", "Relocate3D", ""):
        gmsh.model.mesh.optimize(method)


def mesh_quality() -> tuple[int, float, float]:
    """Return the number of tetrahedra, and the least and the mean of their quality γ.

    γ is the radius of the inscribed over that of the circumscribed sphere, 1 for a regular one.
    """
    tags, _ = gmsh.model.mesh.getElementsByType(4)
    quality = np.asarray(gmsh.model.mesh.getElementQualities(tags, "gamma"))
    return len(tags), float(quality.min()), float(quality.mean())


def write_gmsh(file: Path) -> None:
    """Write the current mesh, nodes and cells of named bodies and surfaces only."""
    gmsh.option.setNumber("Mesh.SaveAll", 0)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(str(file))
