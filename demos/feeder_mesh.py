"""Mesh of feeder.toml: a bush with a feeder, cast round a core into a die with a chill.

    python3 demos/feeder_mesh.py [feeder.msh] [element size in mm]

Half a section in (r, z), six bodies: casting, mould, chill, core, sleeve, cover.
"""

import sys

import gmsh

MM = 1e-3


def rectangle(left: float, right: float, bottom: float, top: float) -> tuple[int, int]:
    """Return a rectangle [mm]."""
    part = (left * MM, bottom * MM, 0.0, (right - left) * MM, (top - bottom) * MM)
    return 2, gmsh.model.occ.addRectangle(*part)


def write_mesh(file: str, size: float) -> None:
    """Write the mesh with an element size [mm]."""
    gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("feeder")
    occ = gmsh.model.occ
    bush, feeder = rectangle(20, 40, 10, 60), rectangle(20, 34, 60, 100)
    casting, _ = occ.fuse([bush], [feeder])
    channel = (2, occ.addDisk(56 * MM, 35 * MM, 0.0, 4 * MM, 4 * MM))
    mould, _ = occ.cut([rectangle(40, 70, 0, 100)], [channel])
    parts = {
        "casting": casting[0],
        "mould": mould[0],
        "chill": rectangle(20, 40, 0, 10),
        "core": rectangle(5, 20, 0, 106),
        "sleeve": rectangle(34, 40, 60, 100),
        "cover": rectangle(20, 34, 100, 106),
    }
    occ.fragment(list(parts.values())[:1], list(parts.values())[1:])
    occ.synchronize()
    for name, (dimension, tag) in parts.items():
        gmsh.model.addPhysicalGroup(dimension, [tag], name=name)
    for name, box in {
        "base": (0, 100, -1, 1),
        "outside": (69, 71, -1, 107),
        "top": (19, 71, 99, 101),
        "lid": (19, 35, 105, 107),
        "channel": (51, 61, 30, 40),
    }.items():
        gmsh.model.addPhysicalGroup(1, outer_curves(*box), name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size * MM)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size * MM)
    gmsh.model.mesh.generate(2)
    gmsh.write(file)
    gmsh.finalize()


def outer_curves(left: float, right: float, bottom: float, top: float) -> list[int]:
    """Return the curves inside a box [mm] that bound one body only."""
    box = (left * MM, bottom * MM, -MM, right * MM, top * MM, MM)
    curves = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, dim=1)]
    return [tag for tag in curves if len(gmsh.model.getAdjacencies(1, tag)[0]) == 1]


if __name__ == "__main__":
    write_mesh(*(sys.argv[1:2] or ["feeder.msh"]), float((sys.argv[2:] or ["2.5"])[0]))
