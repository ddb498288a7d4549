"""A quarter of a casting with core and chill in a die of two halves, turned in space.

All kinds of places at which more than two bodies meet: the core leaves the casting and enters the
die, the die parts at the casting, and the chill ends on a face of the casting across the parting,
where four bodies meet at a point. The casting has a round edge.
"""

from __future__ import annotations

import gmsh
import numpy as np

from castx.arrays import FloatArray

BODIES = ("casting", "core", "chill", "lower", "upper")
MOULD_FIRST = (
    ("core", "casting"), ("chill", "casting"), ("lower", "casting"), ("upper", "casting"),
    ("lower", "core"), ("upper", "core"), ("lower", "chill"), ("upper", "chill"),
    ("lower", "upper"),
)  # fmt: skip
"""All interfaces, so that each node has room for the gaps of all its pairs."""
CASTING_FIRST = (
    ("casting", "core"), ("casting", "chill"), ("casting", "lower"), ("casting", "upper"),
    ("core", "lower"), ("core", "upper"), ("chill", "lower"), ("chill", "upper"),
    ("upper", "lower"),
)  # fmt: skip
HIGH = (0.050, 0.045, 0.060)
"""Corner of the die opposite of the symmetry planes x = y = z = 0 [m]."""
AXIS, ANGLE = (1.0, -2.0, 0.5), 0.7
"""Of the turn about the origin."""


def turn() -> FloatArray:
    """Return the matrix of the turn."""
    x, y, z = np.array(AXIS) / np.linalg.norm(AXIS)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(ANGLE) * across + (1 - np.cos(ANGLE)) * across @ across)


def draw(size: float = 0.02) -> None:
    """Put the mesh into the current gmsh model, with cells of a size [m]."""
    occ = gmsh.model.occ
    casting = box((0.0, 0.0, 0.015), (0.025, 0.025, 0.040))
    occ.synchronize()
    casting = occ.fillet([casting[1]], [upright(0.025, 0.025)], [0.008])[0]
    core = (3, occ.addCylinder(0.0, 0.0, 0.008, 0.0, 0.0, HIGH[2] - 0.008, 0.009))
    chill = box((0.0, 0.025, 0.020), (0.012, 0.034, 0.034))
    lower, upper = box((0.0, 0.0, 0.0), (*HIGH[:2], 0.028)), box((0.0, 0.0, 0.028), HIGH)
    core = occ.intersect([core], [box((0.0, 0.0, 0.0), HIGH)])[0][0]
    casting = occ.cut([casting], [core], removeTool=False)[0][0]
    inner = [casting, core, chill]
    halves = [occ.cut([half], inner, removeTool=False)[0][0] for half in (lower, upper)]
    _, pieces = occ.fragment(inner, halves)
    occ.synchronize()
    for name, found in zip(BODIES, pieces, strict=True):
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in found], name=name)
    name_faces()
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.affineTransform(np.column_stack([turn(), np.zeros(3)]).ravel())


def box(low: tuple[float, ...], high: tuple[float, ...]) -> tuple[int, int]:
    """Return the box between two corners."""
    return 3, gmsh.model.occ.addBox(*low, *np.subtract(high, low))


def upright(x: float, y: float) -> int:
    """Return the edge along z at a place."""
    around = (x - 1e-4, y - 1e-4, -1.0, x + 1e-4, y + 1e-4, 1.0)
    ((_, tag),) = gmsh.model.getEntitiesInBoundingBox(*around, 1)
    return int(tag)


def name_faces() -> None:
    """Name the free faces: three planes of symmetry and the sides opposite of them."""
    found: dict[str, list[int]] = {}
    for _, tag in gmsh.model.getEntities(2):
        if len(gmsh.model.getAdjacencies(2, tag)[0]) == 1:
            low, high = np.reshape(gmsh.model.getBoundingBox(2, tag), (2, 3))
            for k, axis in enumerate("xyz"):
                for name, place in ((f"plane-{axis}", 0.0), (f"far-{axis}", HIGH[k])):
                    if max(abs(low[k] - place), abs(high[k] - place)) < 1e-5:
                        found.setdefault(name, []).append(tag)
    for name, tags in found.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
